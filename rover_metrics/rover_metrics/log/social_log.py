"""The log of RoboTerrain's social collector, row by row: a rover, its goals, and how far people are."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rover_metrics.core.columns import Field

Point = tuple[float, float]


@dataclass(frozen=True)
class SocialRow:
    """One second."""

    step: int  # from 1 on
    time_s: float  # since the start [s]
    position: Point  # of the rover [m]
    speed: float  # mean since the row before [m/s]; NaN in the first row
    distances: tuple[float, ...]  # to each person, in alphabetical order, seen from above [m]
    goals: int  # reached so far

    def as_fields(self) -> list[Field]:
        """Returns the cells, two decimals each."""
        nearest = min(self.distances, default=math.nan)
        numbers = (self.time_s, *self.position, self.speed, *self.distances, nearest)
        return [self.step, *(f"{number:.2f}" for number in numbers), self.goals]


def social_columns(actors: Sequence[str]) -> tuple[str, ...]:
    """Returns the header for people of those names, as NAME_actor."""
    distances = (f"{name}_dist" for name in sorted(actors))
    return ("step", "time_s", "robot_x", "robot_y", "speed_mps", *distances, "dmin", "goals_count")


class SocialRows:
    """Makes the rows of one run from where everybody is each second."""

    def __init__(self) -> None:
        self._step, self._before, self._before_s = 0, (math.nan, math.nan), 0.0

    def next(self, time_s: float, rover: Point, people: Mapping[str, Point], goals: int) -> SocialRow:
        """Returns the next row.

        Args:
            time_s: Since the start [s].
            rover: x, y in the world [m].
            people: x, y of each in the world [m], by name.
            goals: How many were reached so far.
        """
        passed = time_s - self._before_s
        speed = math.dist(rover, self._before) / passed if passed > 0.0 else math.nan
        self._step, self._before, self._before_s = self._step + 1, rover, time_s
        distances = tuple(math.dist(rover, people[name]) for name in sorted(people))
        return SocialRow(self._step, time_s, rover, speed, distances, goals)
