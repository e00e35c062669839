"""A route that is known beforehand: straight legs, each walked at a constant speed, over and over.

Where somebody is at a time is a closed form of the time alone. Heads turn as RoboTerrain's people do:
into the next leg within TURN_S, here behind the corner.
"""

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Self

from harness.base.errors import UsageError
from harness.samples import Place

TURN_S = 0.1  # [s]
SAME = 1e-9  # [m]: nearer points are one
LONGEST_ROUTE = 1_000_000  # way points

Point = tuple[float, ...]  # x, y and, where it counts for the length, z [m]


@dataclass(frozen=True, eq=False)
class Route:
    """Points with the times at which they are passed."""

    times: tuple[float, ...]  # from 0 on, ascending [s]
    points: tuple[tuple[float, float], ...]  # x and y of each in the world [m]
    loops: bool = True  # whether it begins anew at its end; else its end is where one stays
    delay: float = 0.0  # before it begins [s]

    @classmethod
    def at_speed(
        cls, points: Sequence[Point], speed: float, *, closed: bool = False, delay: float = 0.0
    ) -> Self:
        """Returns the route along points at one speed, back the same way or straight from end to start.

        Args:
            points: Two coordinates each, or three; then height counts for the speed.
            speed: [m/s].
            closed: Whether the last leg leads from the end to the start; else one turns round there.
            delay: Before it begins [s].
        """
        distinct = [points[0]]
        for point in points[1:]:
            if math.dist(point, distinct[-1]) > SAME:
                distinct.append(point)
        path = [*distinct, distinct[0]] if closed else [*distinct, *distinct[-2::-1]]
        times = [0.0]
        for before, after in pairwise(path):
            times.append(times[-1] + math.dist(before, after) / speed)
        return cls(tuple(times), tuple((point[0], point[1]) for point in path), True, delay)

    def place(self, time_s: float) -> Place:
        """Returns where one is and looks at a time [s]."""
        passed = max(0.0, time_s - self.delay)
        x, y = self._at(passed)
        was_x, was_y = self._at(max(0.0, passed - TURN_S))
        if math.hypot(x - was_x, y - was_y) > SAME:
            return Place(x, y, math.atan2(y - was_y, x - was_x))
        return Place(x, y, self._heading(passed))

    def _leg(self, passed: float) -> tuple[int, float]:
        """The leg at a time since the begin, and the time since its round began."""
        end = self.times[-1]
        within = passed % end if self.loops and end > 0.0 else min(passed, end)
        return min(bisect_right(self.times, within) - 1, len(self.points) - 2), within

    def _at(self, passed: float) -> tuple[float, float]:
        if len(self.points) == 1:
            return self.points[0]
        leg, within = self._leg(passed)
        (x, y), (to_x, to_y) = self.points[leg : leg + 2]
        begin, end = self.times[leg : leg + 2]
        share = (within - begin) / (end - begin) if end > begin else 1.0
        return x + share * (to_x - x), y + share * (to_y - y)

    def _heading(self, passed: float) -> float:
        """The heading of the leg; where one stands still, of the next leg that leads anywhere."""
        legs = len(self.points) - 1
        first, _ = self._leg(passed) if legs else (0, 0.0)
        for leg in (*range(first, legs), *range(first)):
            (x, y), (to_x, to_y) = self.points[leg : leg + 2]
            if math.hypot(to_x - x, to_y - y) > SAME:
                return math.atan2(to_y - y, to_x - x)
        return 0.0


def timed(
    times: Sequence[float], points: Sequence[Point], *, loops: bool, delay: float, who: str
) -> Route:
    """Returns the route through points at times, as an SDF script has it; UsageError if they descend.

    Args:
        times: Of the points [s].
        points: At least one.
        loops: Whether it begins anew at its end.
        delay: Before it begins [s].
        who: The actor, for the message.
    """
    if any(after < before for before, after in pairwise(times)) or times[0] < 0.0:
        raise UsageError(f"{who}: the times of its way points do not ascend from 0 on; mend <time>")
    since = tuple(time - times[0] for time in times)
    return Route(since, tuple((point[0], point[1]) for point in points), loops, delay + times[0])
