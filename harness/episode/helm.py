"""Steering a run while it goes on: its pace, and orders to its rovers, from other threads.

Orders come into effect between two control periods, at a time that is known. So what was ordered can be
written as the plan of another run, which then gives the same bytes.
"""

import time
from collections import deque
from functools import partial
from typing import TYPE_CHECKING, NamedTuple, Protocol

from harness.base.interrupt import NAP, StopRequest
from harness.base.sim_time import NANOSECONDS
from harness.episode.loop import Pacer
from harness.samples import Place, Twist
from harness.spec.run import Run
from rover_metrics.core.columns import Row
from rover_metrics.core.thresholds import Thresholds

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

    from harness.episode.batch import Batch
    from harness.episode.stream import EpisodeStream, RoverOrders


class Order(NamedTuple):
    """What a control period of a rover begins with, in this order.

    Attributes:
        reset: Whether it goes to its start, or to `place`.
        driver: Who drives from then on: a driver's name; "" for that of the run; None for no change.
        command: For a driver that obeys commands.
        held: Whether the command holds until the next one, unless a time-out is asked for.
        goal: For a driver that takes goals.
    """

    reset: bool = False
    place: Place | None = None
    driver: str | None = None
    command: Twist | None = None
    held: bool = False
    goal: Place | None = None

    def then(self, later: "Order") -> "Order":
        """Returns both orders as one; a reset leaves nothing of what was ordered before.

        Nor does a hand-over leave a command or a goal, since they were the former driver's.
        """
        if later.reset:
            return later
        if later.driver is not None:
            return later._replace(reset=self.reset, place=self.place)
        changes = {name: v for name, v in later._asdict().items() if v not in (None, False)}
        held = self.held if later.command is None else later.held
        return self._replace(**changes | {"held": held})


class Metered(Protocol):
    """The metrics of a rover, as they are logged."""

    @property
    def last_row(self) -> Row | None:
        """The latest row of the log; None before the first."""

    @property
    def thresholds(self) -> Thresholds:
        """What counts as an event."""

    def use(self, thresholds: Thresholds) -> None:
        """Replaces the thresholds from the next sample on."""


class Given(NamedTuple):
    """An order, and the control period with which it came into effect."""

    at_ns: int
    number: int
    order: Order


class Helm(Pacer):
    """The pace of a run and the orders to its rovers; without any it is a Pacer.

    Args:
        rate: Simulated seconds per wall second at first; None does not wait.
        stop: Ends the run, also while it is paused.

    Attributes:
        rate: Simulated seconds per wall second from now on; None does not wait.
        paused: Whether the run stands still between two control periods.
        idle: Called again and again meanwhile.
        held_s: Wall time for which it has stood still [s].
        metered: The metrics of each rover, once the run has begun.
        given: All orders that were followed.
    """

    def __init__(self, rate: float | None, stop: StopRequest) -> None:
        super().__init__(rate, sleep=stop.sleep)
        self.rate, self.paused, self.held_s = rate, False, 0.0
        self.idle: Callable[[], object] = partial(stop.sleep, NAP)
        self.metered: Sequence[Metered] = ()
        self.given: list[Given] = []
        self._rovers: Sequence[RoverOrders] = ()
        self._stop, self._steps, self._judged = stop, 0, False
        self._orders = deque[tuple[int, Order]]()
        self._thresholds: dict[int, Thresholds] = {}

    def step(self) -> None:
        """Lets a paused run go on by one control period."""
        self._steps += 1

    def take_step(self) -> bool:
        """Returns whether a step was asked for, which is taken with that."""
        taken = self._steps > 0
        self._steps -= taken
        return taken

    def order(self, number: int, order: Order) -> None:
        """Orders something of the rover at a place of the run."""
        self._orders.append((number, order))

    def last_row(self, number: int) -> Row | None:
        """Returns the latest row of the log of the rover at a place of the run, if there is any."""
        return self.metered[number].last_row if self.metered else None

    def thresholds(self, number: int) -> Thresholds:
        """Returns the thresholds of the rover at a place of a run that has begun, as ordered."""
        return self._thresholds.get(number) or self.metered[number].thresholds

    def judge(self, number: int, thresholds: Thresholds) -> None:
        """Replaces the thresholds for the metrics of the rover at a place of the run."""
        self._thresholds[number] = thresholds

    def wait_until(self, simulation_ns: int) -> None:
        """Waits until wall time has caught up with a simulation time, at the present rate."""
        if self.rate != self._rate:
            self._rate = self.rate
            if self._rate is not None:
                self._start_ns = self._clock() - round(simulation_ns / self._rate)
        super().wait_until(simulation_ns)

    def begin(self) -> None:
        """Begins simulated time now: what came before took its own."""
        self._start_ns = self._clock()

    def go_on(self, simulation_ns: int) -> None:
        """Waits, after a control period, while it is paused, then until a simulation time."""
        self._hold()
        self.wait_until(simulation_ns)

    def steered(self, stream: "EpisodeStream") -> "Generator[tuple[Batch, ...]]":
        """Yields the batches of a run's control periods; between two of them, orders are followed."""
        self._rovers = stream.rovers
        self._hand_on(stream.next_ns)
        self.begin()
        for period in stream.batches():
            yield period
            self._hold()
            self._hand_on(stream.next_ns)

    def driven(self, run: Run) -> Run:
        """Returns the run as it was driven: with all that was ordered of its rover in its plan."""
        plan, given = run.plan, [(each.at_ns / NANOSECONDS, each.order) for each in self.given]
        if not given or len(run.rovers) > 1:
            return run
        resets = [at for at, order in given if order.reset]
        drivers = [(at, order.driver) for at, order in given if order.driver is not None]
        commands = [(at, c.linear, c.angular) for at, order in given if (c := order.command) is not None]
        goals = [(at, g.x, g.y, g.yaw) for at, order in given if (g := order.goal) is not None]
        return run.but(
            plan=plan.but(
                resets=(*plan.resets, *resets),
                drivers=(*plan.drivers, *drivers),
                commands=(*plan.commands, *commands),
                goals=(*plan.goals, *goals),
            )
        )

    def note(self, run: Run) -> str:
        """Returns a note on a run that was steered; "" if it was not."""
        if not (self.given or self._judged):
            return ""
        is_sent = any(each.order.goal is not None for each in self.given)
        is_refused = is_sent and (run.rover.goal_area or run.plan.route) is not None
        by_others = any(rover.is_shared for rover in self._rovers)
        unplanned = self._judged or by_others or is_refused
        repeats = len(run.rovers) == 1 and not unplanned
        return f", steered by hand: its arguments {'repeat' if repeats else 'do not repeat'} it"

    def _hold(self) -> None:
        if not self.paused:
            self._steps = 0
            return
        began = time.monotonic()
        while self.paused and not self.take_step() and self._stop.signal is None:
            self.idle()
        held = time.monotonic() - began
        self.held_s += held
        self.postpone(held)

    def _hand_on(self, at_ns: int | None) -> None:
        """Orders what comes into effect at a time [ns]; None for never."""
        self._judged |= bool(self._thresholds)
        for number, thresholds in self._thresholds.copy().items():
            self.metered[number].use(thresholds)
            if self._thresholds[number] is thresholds:  # else somebody has moved one more meanwhile
                del self._thresholds[number]
        merged: dict[int, Order] = {}
        while self._orders:
            number, order = self._orders.popleft()
            merged[number] = merged.get(number, Order()).then(order)
        if at_ns is not None:
            for number, order in merged.items():
                self._rovers[number].give(order)
                self.given.append(Given(at_ns, number, order))
