"""A world with all its rovers in fixed steps: one MuJoCo model, integer time, health.

Time is `step * timestep_ns`; a tick is the period of /clock, a whole number of steps. Nothing here
knows ROS, drivers or sample rates.
"""

from collections.abc import Callable, Iterator, Sequence
from itertools import groupby
from typing import TYPE_CHECKING

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import TICK_NS, TICKS_PER_CONTROL
from harness.physics.ahead import Ahead, has_second_core
from harness.physics.aside import Errand
from harness.physics.contacts import ContactWatch
from harness.physics.crowd import Crowd
from harness.physics.health import check_health, check_place
from harness.physics.passed_over import obstacles_of
from harness.physics.rover import Rover, State
from harness.physics.scene import Scene
from harness.physics.soil import soil_bed
from harness.physics.start import settle
from harness.physics.stepping import Span
from harness.physics.stepping_record import SPAN
from harness.physics.world_geoms import soil_ground
from harness.robots.model import keep_mujoco_quiet
from harness.world.heightfield import EDGE_MARGIN, Heightfield

if TYPE_CHECKING:
    from harness.soil.bed import Bed


class Physics:
    """All rovers of a world, settled on the ground at time zero.

    Args:
        scenes: Of the rovers, in one model.
        timestep_ns: Of the model.
        settled: The rovers' states at time zero, from when the same scenes settled before; saves to do
            it again.
        ruts: What the ground is like at time zero; None for fresh ground.

    Attributes:
        rovers: What belongs to each.
        model: The compiled scene.
        data: MuJoCo's state.
        step_count: Steps since time zero.
        steps_per_tick: Steps of one clock tick.
        contacts: What the rovers touch.
        tick_sum: MuJoCo's sensor values, each summed over the steps of the tick that is shown.
        span: Most ticks that can be simulated in one go; 1 with people, who see where rovers are.
        crowd: The people who walk about; None without any.
        bed: The soil under the wheels; None on rigid ground.
        ground: What is driven on, with the ruts of now.
    """

    def __init__(
        self,
        scenes: Sequence[Scene],
        timestep_ns: int,
        settled: Sequence[State] = (),
        ruts: "Bed | None" = None,
    ) -> None:
        keep_mujoco_quiet()  # its counters are checked on every tick
        self.model = scenes[0].model
        self.model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
        self.data = mujoco.MjData(self.model)
        self.timestep_ns = timestep_ns
        self.steps_per_tick = TICK_NS // timestep_ns
        self.step_count = self._began = self._tick = self._simulated = 0
        self.tick_sum = np.zeros(self.model.nsensordata)
        self.contacts, parked = ContactWatch(scenes, self.data), set[str]()
        self.bed, self.ground = soil_bed(scenes, self.data), scenes[0].world.ground
        if self.bed is not None:
            fine = soil_ground(scenes[0].world)
            self.ground = Heightfield(self.bed.surface, fine.cell, fine.middle)
            if ruts is not None:
                self.bed.lay(ruts)
        self.rovers = tuple(
            Rover(scene, self.data, contacts, parked, self.bed)
            for scene, contacts in zip(scenes, self.contacts.rovers, strict=True)
        )
        motors = np.concatenate([rover.motors for rover in self.rovers])
        bounds = self.ground.bounds(EDGE_MARGIN)
        fence = np.array([[rover.qpos_at, *bounds] for rover in self.rovers])
        self._span = Span(self.model, self.data, motors, obstacles_of(scenes, self.data), fence)
        begin = 0
        for rover in self.rovers:
            end = begin + rover.motors.size
            rover.ahead, begin = self._span.commands[:, begin:end], end
        self.crowd = Crowd(scenes, self.data) if scenes[0].world.people else None
        self.span = SPAN if self.crowd is None else 1
        self._scenes, self._is_launched = scenes, False
        self._has_come = False  # whether the last ticks are those that were launched
        self._ahead: Ahead | None = None
        self._taken: int | None = None  # where steps ended that somebody else did
        for rover, state in zip(self.rovers, settled, strict=bool(settled)):
            rover.restore(state)
            rover.parking.hold(True)
        if not settled:
            settle(self, [(rover, rover.scene.world.start) for rover in self.rovers])
        if self.bed is not None and ruts is None:
            self.bed.smooth()

    @property
    def time_ns(self) -> int:
        """Simulation time."""
        return self.step_count * self.timestep_ns

    def tick(self) -> None:
        """Advances one clock tick under what is commanded now, as `run`, and shows its end.

        Raises:
            RunFailed: The state diverged, or a rover reached the edge of the map.
        """
        for rover in self.rovers:
            rover.ahead[0], rover.parked = self.data.ctrl[rover.motors], [rover.parking.held]
        self.run()
        for _ in self.shown():
            pass

    def run(self, *, watched: bool = True) -> None:
        """Simulates the ticks for which all rovers have been commanded; `shown` is to be called next.

        Args:
            watched: Whether anybody asks which contacts there were, not only how many.
        """
        self._began, per_tick, self._has_come = self.step_count, self.steps_per_tick, False
        if self._ahead is not None and self._is_launched:
            self._simulated, self._is_launched = self._ahead.land() // per_tick, False
            self._has_come = True
            return
        if self._taken is not None:
            self._simulated, self._taken = self._taken // per_tick, None
            return
        self._prepare(watched=watched)
        self._simulated = 0
        parked = zip(*(rover.parked for rover in self.rovers), strict=True)
        for holds, alike in groupby(parked):
            self._hold(holds)
            begin, end = self._simulated * per_tick, (self._simulated + len(list(alike))) * per_tick
            step = self._span.advance((begin, end, per_tick), self.contacts)
            self._simulated = step // per_tick
            if step < end:
                break

    @property
    def can_launch(self) -> bool:
        """Whether there is another core, and nobody has to see what is simulated tick by tick."""
        return self.crowd is None and self.bed is None and has_second_core()

    @property
    def has_landed(self) -> bool:
        """Whether what was launched is done, so that the next `run` need not wait."""
        return self._ahead is not None and self._is_launched and self._ahead.has_landed

    def show_end(self) -> bool:
        """Shows the last of the ticks that have just been simulated, before `shown` shows them all.

        Returns:
            Whether all is well, and the next ones may be simulated while these are shown.
        """
        if not self._simulated or not self._is_well():
            return False
        self._tick = self._simulated - 1
        self._span.show(self._tick, self.tick_sum)
        self.step_count = self._began + self._simulated * self.steps_per_tick
        return True

    def _is_well(self) -> bool:
        if self._ahead is not None and self._has_come:
            return self._ahead.is_well
        return not self._span.is_wrong()

    def launch(self, errands: Sequence[Errand] = (), *, awake: bool) -> None:
        """Lets another core simulate what all rovers have been commanded, while `shown` shows the end.

        The next `run` waits for it, or does it itself where rovers park or set off within these ticks.

        Args:
            errands: What it does with the state at the end, one of each rover at most.
            awake: How they wait for each other, as `Aside` has it.
        """
        if self._ahead is None:
            self._ahead = Ahead(self._scenes, self.data, self._span, self.contacts, awake=awake)
        ticks = list(zip(*(rover.parked for rover in self.rovers), strict=True))
        if ticks.count(ticks[0]) == len(ticks):
            for rover, held in zip(self.rovers, ticks[0], strict=True):
                if rover.drag.acts or rover.parking.held != held:
                    self.halt()
            self._turn_drag()
            self._hold(ticks[0])
            steps = len(ticks) * self.steps_per_tick
            self._is_launched = self._ahead.launch(steps, self.steps_per_tick, errands)

    def offer(self) -> tuple[int, int, int, int] | None:
        """Returns what another thread may do instead of the next `run`, with no contact watched.

        It is what `steps_kernel.advance` takes: RECORD, BEGIN, END and PER_TICK of `stepping_record`.
        Until it has been given to `take` nobody may look. None where rovers park or set off within
        these ticks, or where they are done already.
        """
        ticks = list(zip(*(rover.parked for rover in self.rovers), strict=True))
        if len(set(ticks)) != 1 or self._taken is not None:
            return None
        self._prepare(watched=False)
        self._hold(ticks[0])
        per_tick = self.steps_per_tick
        return self._span.passed(self.contacts), 0, len(ticks) * per_tick, per_tick

    def take(self, ended: int) -> None:
        """Takes note of where the steps ended that were offered, for the next `run`."""
        self._taken = ended

    def halt(self) -> None:
        """Takes back what another core has begun of the next step, since friction is to change.

        Nothing may be under way: it is for between `run` and `launch`.
        """
        if self._ahead is not None:
            self._ahead.halt()

    def stay(self) -> None:
        """Ends what has been launched, and its thread."""
        if self._ahead is not None:
            if self._is_launched:
                self._ahead.land()
            self._ahead.come_back()
            self._ahead.close()
        self._ahead, self._is_launched = None, False

    def _prepare(self, *, watched: bool) -> None:
        self.contacts.begin(watches=watched)
        if self.crowd is not None:
            self.crowd.move(self.time_ns + TICK_NS)
        self._turn_drag()

    def _turn_drag(self) -> None:
        if self.step_count % (TICKS_PER_CONTROL * self.steps_per_tick) == 0:  # observed or not
            for rover in self.rovers:
                rover.drag.turn(rover.twist[:2])

    def _hold(self, holds: Sequence[bool]) -> None:
        for rover, held in zip(self.rovers, holds, strict=True):
            rover.parking.hold(held)

    def shown(self, needed: Callable[[int], bool] = lambda _: True) -> Iterator[int]:
        """Shows one tick after the other of those that have just been simulated.

        While a tick is shown, time, the rovers' contacts and `now`, and if it is needed also `tick_sum`
        and what `stepping.RECORDED` names of MuJoCo's state are those of its end; whatever else MuJoCo
        knows is that of the last one, which is always needed. All are to be consumed.

        Args:
            needed: Whether anybody looks at a tick's state.

        Yields:
            The index of the tick, from 0.

        Raises:
            RunFailed: The state diverged in a tick, or a rover reached the edge of the map.
        """
        if self._ahead is not None and not self._is_launched:
            self._ahead.come_back()
        last, touched = self._simulated - 1, self.contacts.any
        paths = [self._span.path(rover.qpos_at) for rover in self.rovers]
        for tick in range(self._simulated):
            self._tick = tick
            if tick == last or needed(tick):
                self._span.show(tick, self.tick_sum)
            self.step_count = self._began + (tick + 1) * self.steps_per_tick
            for rover, path in zip(self.rovers, paths, strict=True):
                rover.now = path[tick]
                if touched:
                    rover.contacts.show(tick)
            if self.crowd is not None:
                self.crowd.look([rover.contacts for rover in self.rovers])
            if tick == last:
                if any(self._span.warnings.tolist()):  # a third of the time of numpy's any
                    check_health(self.data, self.rovers, self.time_ns)
                check_place(self.rovers, self.time_ns)
            yield tick

    @property
    def is_last_shown(self) -> bool:
        """Whether the tick that is shown is the last one of those that were simulated in one go."""
        return self._tick == self._simulated - 1

    def latest_sums(self, ticks: int) -> NDArray[np.float64]:
        """Returns the `tick_sum` of that many ticks up to the one that is shown, a row of each."""
        return self._span.sums[self._tick + 1 - ticks : self._tick + 1]

    def put_back(self, rover: Rover) -> None:
        """Takes note that a rover is put elsewhere, and takes out all ruts once all have been in a tick.

        One of several leaves the ruts to the others, which may stand in them.
        """
        rover.put_back_at, soil = self.step_count, rover.scene.world.soil
        are_back = all(each.put_back_at == self.step_count for each in self.rovers)
        if are_back and self.bed is not None and soil is not None and not soil.keeps_ruts:
            self.bed.smooth()
