"""The clock ticks that are simulated in one go: what is commanded before, what each was like after."""

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.contacts import ContactWatch
from harness.physics.passed_over import PassedOver
from harness.physics.steps_kernel import SPAN, Integers, addresses, advance, is_wrong

RECORDED = ("qpos", "qvel", "qfrc_actuator")  # of MuJoCo's state at the end of a tick

Doubles = NDArray[np.float64]
Stepping = tuple[Any, ...]  # what `steps_kernel.advance` takes beside steps: arrays of one MjData


class Span:
    """Steps a model through the ticks of a control period, or fewer, and knows what they were like.

    Args:
        model: The compiled scene.
        data: Its state.
        motors: Controls that are commanded.
        obstacles: Those that are passed over while no rover can touch them.

    Attributes:
        motors: Controls that are commanded.
        obstacles: As given.
        commands: To them in each tick, shape (SPAN, motors).
        warnings: MuJoCo's counters of them.
        sums: MuJoCo's sensor values summed over the steps of each tick, shape (SPAN, sensors).
        fence: Where each rover's pose stands in qpos, and x from, x to, y from, y to between which it
            may be [m], shape (rovers, 5).
    """

    fence: Doubles

    def __init__(
        self, model: mujoco.MjModel, data: mujoco.MjData, motors: Integers, obstacles: PassedOver
    ) -> None:
        self.motors, self.commands = motors, np.zeros((SPAN, motors.size))
        self.obstacles = obstacles
        self.warnings = data.warning.number  # a view: MuJoCo counts up in it
        self._pointers = *addresses(), model._address, data._address  # noqa: SLF001 - no other name
        self._control = data.ctrl, motors, self.commands
        self.sums = np.zeros((SPAN, data.sensordata.size))
        self._felt = data.sensordata, self.sums
        self._state: tuple[Doubles, ...] = tuple(getattr(data, name) for name in RECORDED)
        self._record = tuple(np.zeros((SPAN, part.size)) for part in self._state)

    def advance(self, steps: tuple[int, int, int], watch: ContactWatch) -> int:
        """Steps to the end, or until a tick after which there are warnings or a rover left its fence.

        Args:
            steps: Where to begin and to end, counted from the first tick's first step; steps of a tick.
            watch: Learns what is touched.

        Returns:
            Where it ended, counted as in `steps`.
        """
        step, end, per_tick = steps
        while True:
            pointers, *rest = self.arguments(watch)
            step = advance(pointers, (step, end, per_tick, 0), *rest)
            if step >= 0:
                return step
            step = -step
            watch.look((step - 1) // per_tick)

    def arguments(self, watch: ContactWatch) -> Stepping:
        """Returns what `steps_kernel.advance` takes, but for its steps."""
        health, recorded = (self.warnings, self.fence), (self._state, self._record)
        watched = watch.contacts, watch.watched
        return self._pointers, self._control, health, self._felt, recorded, *watched, self.obstacles

    def is_wrong(self) -> bool:
        """Returns whether there are warnings, or a rover left its fence."""
        return is_wrong((self.warnings, self.fence), self._state[0])

    def take(self, other: "Span") -> None:
        """Takes over what the ticks of another span were like, one of the same model."""
        self.sums[:] = other.sums
        for part, values in zip(self._record, other._record, strict=True):  # noqa: SLF001 - its class
            part[:] = values

    def path(self, at: int) -> list[list[float]]:
        """Returns what a rover's pose, which stands there in qpos, was at the end of each tick."""
        path: list[list[float]] = self._record[0][:, at : at + 7].tolist()
        return path

    def show(self, tick: int, sums: Doubles) -> None:
        """Sets what RECORDED names to what it was at the end of a tick, and the sums of its sensors."""
        for part, values in zip(self._state, self._record, strict=True):
            part[:] = values[tick]
        sums[:] = self.sums[tick]
