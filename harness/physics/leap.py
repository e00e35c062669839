"""Several ticks of a simulation in one call of MuJoCo, which other threads need not wait for.

`Simulation.tick` takes Python between two steps, to see what is touched and how hard. Who only wants to
know that something was touched, as the contact sensors tell, leaps: mujoco.rollout steps on the calling
thread and gives the interpreter free meanwhile. Same states, same sums, to the bit: the warm start and
the parking of the wheels are carried over.

What Python prepares is apart from what MuJoCo does: who leaps with many simulations lets all take their
commands first, for then the processor still has Python's work in its caches.
"""

from collections.abc import Iterator
from functools import partial
from itertools import groupby

import mujoco
import numpy as np
from mujoco.rollout import Rollout
from numpy.typing import NDArray

from harness.physics.simulation import Simulation

STATE, CONTROL = int(mujoco.mjtState.mjSTATE_FULLPHYSICS), int(mujoco.mjtState.mjSTATE_CTRL)


class Leap:
    """Leaps over a fixed number of clock ticks of one simulation."""

    def __init__(self, simulation: Simulation, ticks: int) -> None:
        model, steps = simulation.model, ticks * simulation.steps_per_tick
        self._simulation, self._ticks = simulation, ticks
        self._rollout = Rollout(nthread=0)
        self._begin = np.empty((1, mujoco.mj_stateSize(model, STATE)))
        self._warm_start = np.empty((1, model.nv))
        self._controls = np.empty((1, steps, model.nu))
        self._states = np.empty((1, steps, self._begin.size))
        self._sensors = np.empty((1, steps, model.nsensordata))
        self._legs: list[slice] = []
        # Views: of the ticks' controls, of their last states after the time, of their sensor values.
        self._ticks_controls = self._controls.reshape(ticks, -1, model.nu)
        moving = slice(1, 1 + model.nq + model.nv)
        self._ends = self._states.reshape(ticks, -1, self._begin.size)[:, -1, moving]
        self._ticks_sensors = self._sensors.reshape(ticks, -1, model.nsensordata)

    def take(self, commands: NDArray[np.float64]) -> None:
        """Takes the commands under which `run` will simulate; the state must stay as it is until then.

        Args:
            commands: Of each tick as `Simulation.command_wheels` takes them, shape (ticks, motors).
        """
        self._commands = commands
        self._legs.clear()
        begin = 0
        for _, alike in groupby(map(any, commands[:, : self._simulation.driven].tolist())):
            end = begin + len(list(alike))
            self._legs.append(slice(begin, end))  # parked all the time, or not at all
            begin = end
        self._set_out(self._legs[0])

    def run(self) -> None:
        """Simulates the ticks; `ticks` is to be called next."""
        self._go()
        for leg in self._legs[1:]:
            self._set_out(leg)
            self._go()

    def ticks(self) -> Iterator[int]:
        """Shows one tick after the other of those that have just been simulated.

        While a tick is shown, the simulation's time, `tick_sum`, qpos and qvel are those of its end;
        whatever else MuJoCo knows is that of the last one. All are to be consumed.

        Yields:
            The index of the tick, from 0.

        Raises:
            RunFailed: As `Simulation.tick`, of the end of the last tick; none is shown then.
        """
        physics = self._simulation.physics
        begun = physics.step_count
        physics.step_count += self._ticks * physics.steps_per_tick
        physics.check()
        physics.step_count = begun
        qpos, qvel, total = physics.data.qpos, physics.data.qvel, physics.tick_sum
        # Of axis 1, which numpy adds one step after the other, as Simulation.tick does.
        sums = self._ticks_sensors.sum(axis=1)
        for tick, (end, values) in enumerate(zip(self._ends, sums, strict=True)):
            qpos[:], qvel[:], total[:] = end[: qpos.size], end[qpos.size :], values
            physics.step_count += physics.steps_per_tick
            yield tick

    def _set_out(self, leg: slice) -> None:
        """Makes everything ready for some of the ticks."""
        simulation, commands = self._simulation, self._commands[leg]
        model, data, per_tick = simulation.model, simulation.data, simulation.steps_per_tick
        simulation.command_wheels(commands[0])
        self._ticks_controls[leg] = data.ctrl
        self._ticks_controls[leg, :, simulation.motors] = commands[:, None]
        mujoco.mj_getState(model, data, self._begin[0], STATE)
        self._warm_start[0] = data.qacc_warmstart
        steps = slice(leg.start * per_tick, leg.stop * per_tick)
        self._go = partial(
            self._rollout.rollout,
            [model],
            [data],
            self._begin,
            self._controls[:, steps],
            control_spec=CONTROL,
            skip_checks=True,
            nstep=steps.stop - steps.start,
            initial_warmstart=self._warm_start,
            state=self._states[:, steps],
            sensordata=self._sensors[:, steps],
        )
