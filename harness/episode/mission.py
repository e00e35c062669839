"""How a mission goes: what the rover has stopped at, which gates it has passed, what is left to go."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from harness.episode.assembly import route_progress, world_of
from harness.spec.run import Run
from harness.world.route import RouteProgress, Standstill, crossed
from harness.world.targets.placing import Target, Where

MOST_NAMES = 3  # of what was not reached


class MissionState(NamedTuple):
    """A mission up to the end of a control period.

    Attributes:
        reached: Targets: those that it has stopped within reach of, and gates passed.
        gates: Of these the gates.
        points: Way points of the route.
        done_s: When the route was finished [s]; NaN before.
        distances: To each target, by name [m].
        stops: Smallest distance of a stop from each target, by name [m]; NaN without a stop.
    """

    reached: int = 0
    gates: int = 0
    points: int = 0
    done_s: float = math.nan
    distances: dict[str, float] = {}  # noqa: RUF012 - of a value that nobody changes
    stops: dict[str, float] = {}  # noqa: RUF012


class Arrival(NamedTuple):
    """What became of a way point or a target.

    Attributes:
        name: The target's; of a plain way point "".
        place: x, y [m].
        reached_s: When it was reached, or the gate passed [s]; NaN if it was not.
        stop_distance: Of a target: smallest distance of a stop from it [m]; NaN without a stop.
    """

    name: str
    place: Where
    reached_s: float
    stop_distance: float = math.nan


@dataclass(frozen=True)
class MissionOutcome:
    """What a mission came to.

    Attributes:
        way_points: Those of the route, in its order.
        targets: Those of the world.
    """

    way_points: tuple[Arrival, ...]
    targets: tuple[Arrival, ...]

    def rows(self) -> list[tuple[str, str]]:
        """Returns what to tell in a table: "way points" and "targets", where there are any."""
        kinds = {"way points": self.way_points, "targets": self.targets}
        return [(kind, _in_words(arrivals)) for kind, arrivals in kinds.items() if arrivals]


def _in_words(arrivals: Sequence[Arrival]) -> str:
    times = [one.reached_s for one in arrivals if not math.isnan(one.reached_s)]
    by = f" by {max(times):.1f} s" if times else ""
    return f"{len(times)} of {len(arrivals)}{by}{without(arrivals)}"


def without(arrivals: Sequence[Arrival]) -> str:
    """Returns which were not reached, e.g. ", not (3, 4), post"; nothing if all were."""
    left = [
        one.name or "({:g}, {:g})".format(*one.place) for one in arrivals if math.isnan(one.reached_s)
    ]
    more = f" and {len(left) - MOST_NAMES} more" if len(left) > MOST_NAMES else ""
    return f", not {', '.join(left[:MOST_NAMES])}{more}" if left else ""


class MissionAccount:
    """Follows a rover through its mission: the targets of its world, and a route that begins."""

    def __init__(self, targets: Sequence[Target], progress: RouteProgress) -> None:
        self._targets, self._progress = targets, progress
        self._gates = {target.name for target in targets if len(target.posts) == 2}
        self._standstill = Standstill()
        self._before: Where | None = None
        self._reached = dict[str, float]()  # targets, and when [s]
        self._stops = {target.name: math.nan for target in targets}
        self._resets = 0

    def take(self, time_s: float, place: Where, resets: int) -> MissionState:
        """Returns how the mission stands.

        Args:
            time_s: Since the start [s].
            place: Of the rover in the world [m].
            resets: Times that it was put back so far.
        """
        if resets != self._resets:
            self._resets = resets
            self._before = None
            self._standstill.carried_away()
            self._progress.carried_away()
        self._progress.observe(time_s, place)
        before, self._before = self._before or place, place
        distances = {target.name: math.dist(place, target.position[:2]) for target in self._targets}
        stands = self._standstill.observe(time_s, place)
        if stands:
            self._stops = {name: min(d, self._stops[name]) for name, d in distances.items()}  # d for NaN
        for target in self._targets:
            if target.name in self._gates:
                is_reached = crossed(before, place, *target.posts)
            else:
                is_reached = stands and distances[target.name] <= target.spec.options.reach
            if is_reached:
                self._reached.setdefault(target.name, time_s)
        return MissionState(
            len(self._reached),
            len(self._gates & self._reached.keys()),
            len(self._progress.reached),
            self._progress.done_s,
            distances,
            self._stops,
        )

    def outcome(self) -> MissionOutcome:
        """Returns what the mission came to so far."""
        points = (
            Arrival(mark.name, mark.place, self._progress.reached.get(number, math.nan))
            for number, mark in enumerate(self._progress.marks)
        )
        targets = (
            Arrival(name, target.position[:2], self._reached.get(name, math.nan), self._stops[name])
            for target in self._targets
            for name in [target.name]
        )
        return MissionOutcome(tuple(points), tuple(targets))


def mission_of(run: Run) -> MissionAccount | None:
    """Returns the account of a run's mission, not begun yet; None of a run without targets and route."""
    if not run.world.targets and run.plan.route is None:
        return None
    world = world_of(run)
    return MissionAccount(world.targets, route_progress(run, world))
