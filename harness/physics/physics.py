"""A world with all its rovers in fixed steps: one MuJoCo model, integer time, health.

Time is `step * timestep_ns`; a tick is the period of /clock, a whole number of steps. Nothing here
knows ROS, drivers or sample rates.
"""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from harness.base.errors import Diverged, RunFailed
from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.physics.crowd import Crowd
from harness.physics.rover import Rover, State
from harness.physics.scene import Scene, soil_ground
from harness.physics.soil import soil_bed
from harness.physics.start import spawn_pose
from harness.world.heightfield import EDGE_MARGIN, Heightfield
from harness.world.world import Start

SETTLE_LIMIT_NS = 5 * NANOSECONDS
FREE_NS = 1 * NANOSECONDS  # of that the wheels may roll; held ones would keep rockers from following

HEALTH_WARNINGS = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "position",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocity",
    mujoco.mjtWarning.mjWARN_BADQACC: "acceleration",
    mujoco.mjtWarning.mjWARN_BADCTRL: "wheel command",
}


class Physics:
    """All rovers of a world, settled on the ground at time zero.

    Args:
        scenes: Of the rovers, in one model.
        timestep_ns: Of the model.
        settled: The rovers' states at time zero, from when the same scenes settled before; saves to do
            it again.

    Attributes:
        rovers: What belongs to each.
        model: The compiled scene.
        data: MuJoCo's state.
        step_count: Steps since time zero.
        steps_per_tick: Steps of one clock tick.
        tick_sum: MuJoCo's sensor values, each summed over the steps of the last tick.
        crowd: The people who walk about; None without any.
        bed: The soil under the wheels; None on rigid ground.
        ground: What is driven on, with the ruts of now.
    """

    def __init__(self, scenes: Sequence[Scene], timestep_ns: int, settled: Sequence[State] = ()) -> None:
        # Its counters are checked on every tick; the texts would go into MUJOCO_LOG.TXT in the cwd.
        mujoco.set_mju_user_warning(lambda _: None)
        self.model = scenes[0].model
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self.data = mujoco.MjData(self.model)
        self._warnings = self.data.warning.number  # a view: MuJoCo counts up in it
        self.timestep_ns = timestep_ns
        self.steps_per_tick = TICK_NS // timestep_ns
        self.step_count = 0
        self.tick_sum = np.zeros(self.model.nsensordata)
        parked = set[str]()
        self.bed, self.ground = soil_bed(scenes, self.data), scenes[0].world.ground
        if self.bed is not None:
            fine = soil_ground(self.ground)
            self.ground = Heightfield(self.bed.surface, fine.cell, fine.middle)
        self.rovers = tuple(
            Rover((scene, *scenes[:number], *scenes[number + 1 :]), self.data, parked, self.bed)
            for number, scene in enumerate(scenes)
        )
        self.crowd = Crowd(scenes, self.data) if scenes[0].world.people else None
        for rover, state in zip(self.rovers, settled, strict=bool(settled)):
            rover.restore(state)
            rover.parking.hold(True)
        if not settled:
            self.settle([(rover, rover.scene.world.start) for rover in self.rovers])
        self.smooth()

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.step_count * self.timestep_ns

    def tick(self) -> None:
        """Advances one clock tick; `tick_sum` then holds the sensor values summed over its steps.

        Raises:
            RunFailed: The state diverged, or a rover reached the edge of the map.
        """
        model, data, total = self.model, self.data, self.tick_sum
        watches = [(rover.contacts, rover.contacts.counts) for rover in self.rovers]
        total.fill(0.0)
        for contacts, _ in watches:
            contacts.begin()
        if self.crowd is not None:
            self.crowd.move(self.time_ns + TICK_NS)
        for _ in range(self.steps_per_tick):
            mujoco.mj_step(model, data)
            total += data.sensordata
            for contacts, counts in watches:
                if any(counts.tolist()):
                    contacts.look()
        if self.crowd is not None:
            self.crowd.look([contacts for contacts, _ in watches])
        self.step_count += self.steps_per_tick
        self.check()

    def settle(self, starts: Sequence[tuple[Rover, Start]]) -> None:
        """Lets rovers down onto the ground, so that no drop pollutes the first samples; no time passes.

        Each of them comes to rest as if it were alone: who rests waits for the slower ones as it is, and
        so do all others.

        Args:
            starts: Where each of them is let down.

        Raises:
            Diverged: One of them cannot stand there.
        """
        falling = [rover for rover, _ in starts]
        waiting = [(rover, rover.state()) for rover in self.rovers if rover not in falling]
        for rover, start in starts:
            rover.pose[:] = spawn_pose(rover.scene, start)
        for tick in range(SETTLE_LIMIT_NS // TICK_NS):
            for rover, _ in starts:
                rover.parking.hold(tick >= FREE_NS // TICK_NS)
            for _ in range(self.steps_per_tick):
                mujoco.mj_step(self.model, self.data)
            self.check_health()
            for rover, state in waiting:
                rover.restore(state)
            for rover in [rover for rover in falling if rover.rests(self.data)]:
                falling.remove(rover)
                waiting.append((rover, rover.state()))
            if not falling:
                break
        for rover, _ in starts:
            rover.parking.hold(True)
        self.data.time = 0.0

    def smooth(self) -> None:
        """Takes all ruts out of the ground."""
        if self.bed is not None:
            self.bed.smooth()

    def check(self) -> None:
        """Checks the present state.

        Raises:
            RunFailed: It diverged, or a rover reached the edge of the map.
        """
        self.check_health()
        for rover in self.rovers:
            x, y = rover.pose[:2].tolist()
            if not rover.scene.world.ground.contains(x, y, EDGE_MARGIN):
                raise RunFailed(
                    f"{rover.scene.label} reached the edge of the map at t = {self._now()} "
                    f"(x = {x:.2f} m, y = {y:.2f} m)"
                )

    def check_health(self) -> None:
        """Checks MuJoCo's warnings.

        Raises:
            Diverged: There are some.
        """
        if not any(self._warnings.tolist()):  # a third of the time of numpy's any
            return
        for warning, quantity in HEALTH_WARNINGS.items():
            if self.data.warning[warning].number:
                fastest = max(map(_violence, self.rovers))
                wild = [rover for rover in self.rovers if _violence(rover) == fastest]
                whose = " or ".join(filter(None, (rover.scene.name for rover in wild)))
                pose, twist = wild[0].pose[:3], wild[0].twist[:3]  # what is no number soon spreads
                raise Diverged(
                    f"{whose and whose + ': '}the simulation diverged at t = {self._now()} "
                    f"(NaN, infinite or huge {quantity}); position {pose.round(3).tolist()} m, "
                    f"velocity {twist.round(3).tolist()} m/s; try a smaller --timestep"
                )

    def _now(self) -> str:
        return f"{self.time_ns / NANOSECONDS:.2f} s"


def _violence(rover: Rover) -> float:
    """How fast anything of a rover moves; infinite where that is no number."""
    fastest = float(np.abs(rover.velocities).max())
    return fastest if math.isfinite(fastest) else math.inf
