"""A route in its world, and how far somebody has come on it: for who drives it and who judges it."""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

from harness.base.errors import UsageError, unknown
from harness.spec.route import Route
from harness.world.geodesy import Datum
from harness.world.targets.placing import Target, Where
from rover_metrics.extended.polygon import side_of

STANDING_S, STANDING = 1.0, 0.05  # a stop: so long [s], so little path meanwhile [m]


@dataclass(frozen=True)
class Mark:
    """A way point in the world's metres."""

    place: Where  # x, y [m]; of a gate its middle
    radius: float  # how near is near enough [m]
    within: float = math.inf  # how long it may take [s]
    # its two posts, which are to be passed between; None of a plain place
    gate: tuple[Where, ...] | None = None
    is_solid: bool = False  # whether something stands there, so that nobody can be at the very place
    stop: bool = False  # whether it is reached only by standing there
    name: str = ""  # of the target that is there

    def is_reached(self, before: Where, now: Where) -> bool:
        """Returns whether who went straight from one place to another [m] has reached it."""
        if self.gate is not None:
            return crossed(before, now, *self.gate)
        return math.dist(now, self.place) <= self.radius


def crossed(before: Where, now: Where, left: Where, right: Where) -> bool:
    """Returns whether a step leads between two posts, either way.

    Args:
        before: x, y of its begin [m].
        now: x, y of its end [m].
        left: x, y of a post [m].
        right: x, y of the other [m].
    """
    between = side_of(before, now, left) * side_of(before, now, right) < 0.0
    return between and side_of(left, right, before) * side_of(left, right, now) <= 0.0 and before != now


def marks(route: Route, targets: Iterable[Target], datum: Datum) -> tuple[Mark, ...]:
    """Returns the way points of a route in the world.

    Args:
        route: Places, coordinates and names of targets.
        targets: Those that there are.
        datum: The world's origin on the Earth.

    Raises:
        UsageError: A point names no target.
    """
    known = {target.name: target for target in targets}
    result = []
    for point in route.points:
        within = math.inf if point.within is None else point.within
        if point.target:
            check_target(point.target, known)
            target = known[point.target]
            place, gate = target.position[:2], target.posts if len(target.posts) == 2 else None
        else:
            place, gate = point.at or datum.local(point.lat or 0.0, point.lon or 0.0), None
        is_solid = gate is None and bool(point.target)
        stop = point.stop and gate is None
        result.append(Mark(place, point.radius, within, gate, is_solid, stop, point.target))
    return tuple(result)


def check_target(name: str, names: Iterable[str]) -> None:
    """Raises UsageError if no target has that name."""
    if name not in (known := list(names)):
        lack = "there are no targets" if not known else unknown("target", name, known)
        raise UsageError(f"route: a way point is target '{name}', but {lack}")


@dataclass
class Standstill:
    """Finds out whether somebody stands; call `observe` with the place, step by step."""

    _trail: deque[tuple[float, Where]] = field(default_factory=deque)

    def observe(self, time_s: float, place: Where) -> bool:
        """Returns whether it has stayed within STANDING of a place [m] for STANDING_S, at a time [s]."""
        trail = self._trail
        trail.append((time_s, place))
        while len(trail) > 2 and trail[1][0] <= time_s - STANDING_S:
            trail.popleft()
        is_long = time_s - trail[0][0] >= STANDING_S - 1e-9
        return is_long and all(math.dist(place, before) <= STANDING for _, before in trail)

    def carried_away(self) -> None:
        """Takes note that somebody was put elsewhere: it begins to stand anew."""
        self._trail.clear()


@dataclass
class RouteProgress:
    """Which way points somebody has reached or missed; call `observe` with the place, step by step."""

    marks: tuple[Mark, ...]  # of the route
    any_order: bool = False  # whether the nearest one left is next, instead of the next in order
    limit: float = math.inf  # after which all are missed that are left [s]
    # when each way point was [s], by number, in the order in which they were
    reached: dict[int, float] = field(default_factory=dict)
    current: int | None = None  # the way point to go to; None when none is left
    done_s: float = math.nan  # when the last one was reached, if none was missed [s]; NaN before
    stands: bool = False  # whether somebody has stood for STANDING_S
    _left: list[int] = field(init=False)
    _since_s: float = 0.0
    _before: Where | None = None
    _standstill: Standstill = field(default_factory=Standstill)

    def __post_init__(self) -> None:
        self._left = list(range(len(self.marks)))

    def observe(self, time_s: float, place: Where) -> None:
        """Takes where somebody is, x and y in the world [m], at a time since the start [s]."""
        before, self._before = self._before or place, place
        due = list(self._left) if self.any_order else self._left[:1]
        self.stands = self._standstill.observe(time_s, place)
        near = [number for number in due if self.marks[number].is_reached(before, place)]
        hit = [number for number in near if self.stands or not self.marks[number].stop]
        late = time_s > self.limit
        if hit and not late:
            self.reached |= dict.fromkeys(hit, time_s)
            self._settle(hit, time_s)
            if len(self.reached) == len(self.marks):
                self.done_s = time_s
        elif late:
            self._settle(list(self._left), time_s)
        elif self.current is not None and time_s - self._since_s > self.marks[self.current].within:
            self._settle([self.current], time_s)
        if self.current is None and self._left:
            nearest = min(self._left, key=lambda n: math.dist(place, self.marks[n].place))
            self.current = nearest if self.any_order else self._left[0]

    def carried_away(self) -> None:
        """Takes note that somebody was put elsewhere: the next place is no step from the last one."""
        self._before = None
        self._standstill.carried_away()

    def _settle(self, numbers: list[int], time_s: float) -> None:
        self._left = [number for number in self._left if number not in numbers]
        if self.current is None or self.current in numbers:
            self.current, self._since_s = None, time_s
