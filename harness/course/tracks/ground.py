"""Tracks on named terrains: to points that are drawn out of sight of the start, if it can be."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from harness.base.errors import UsageError
from harness.base.streams import COURSE, generator
from harness.course.planner import Planner
from harness.course.task import Case, Point, Rule, Task
from harness.course.tracks.base import Track
from harness.episode.assembly import world_of
from harness.robots import find_rover

MARGIN = 0.3  # [m] of free ground around a rover that stands at a goal
TRIES = 40  # places that are looked at for one behind something


@dataclass(frozen=True, kw_only=True)
class Ground(Track):
    """A named terrain with goals of its own for each seed.

    Attributes:
        world: Fields of the run that say where, beside the seed.
        faults: What fails; of a seed it is one after the other.
        distance: From one goal to the next, at least and at most [m].
        count: How many goals there are.
        slope_limit: Steepest slope of the shortest way [rad]; None for the rover's own.
    """

    name: str
    summary: str
    world: Mapping[str, object]
    faults: Sequence[tuple[str, ...]] = ((),)
    distance: tuple[float, float] = (9.0, 12.0)
    count: int = 1
    slope_limit: float | None = None
    rule: Rule = field(default_factory=Rule)
    robot: str = "leo"

    def task(self, case: Case, folder: Path) -> Task:  # noqa: ARG002 - it reads no file
        """Returns the task of a seed: its world, and goals that can be reached."""
        faults = self.faults[case.seed % len(self.faults)]
        run = self.run(**self.world, seed=case.seed, faults=faults)
        rover, rng = find_rover(self.robot), generator(case.seed, COURSE, self.name)
        planner = Planner(world_of(run), rover, self.slope_limit)
        way: list[Point] = [(0.0, 0.0)]
        for _ in range(self.count):
            way.append(self._goal(planner, way[-1], rover.reach + MARGIN, rng))
        yaw = math.atan2(way[1][1], way[1][0])
        shortest = planner.length(tuple(way))
        return Task(
            run=run.alone(start=(0.0, 0.0, round(yaw, 3))),
            goals=tuple(way[1:]),
            shortest=shortest,
            optimal=shortest / rover.top_speed,
            rule=self.rule,
        )

    def _goal(self, planner: Planner, start: Point, room: float, rng: np.random.Generator) -> Point:
        """A place that can be reached, out of sight of the start if there is such a one."""
        lengths = planner.lengths(start)
        rows, columns = np.nonzero(np.isfinite(lengths) & (planner.clearance > room))
        cells = zip(rows.tolist(), columns.tolist(), strict=True)
        places = [planner.middle(row, column) for row, column in cells]
        low, high = self.distance
        fit = [place for place in places if low <= math.dist(place, start) <= high]
        if not fit:
            raise UsageError(f"track {self.name}: there is no place for a goal; take another seed")
        drawn = [fit[int(rng.integers(len(fit)))] for _ in range(TRIES)]
        return next((place for place in drawn if not planner.is_open(start, place)), drawn[0])
