"""Shortest ways on the truth: what an entry's time and path are compared with."""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.course.task import Point
from harness.robots import RoverSpec
from harness.world.grid import STEPS, distances, travel
from harness.world.occupancy import FREE, occupancy
from harness.world.world import World

RESOLUTION = 0.1  # [m] of a cell
LARGEST = 400.0  # [m] of a world's side

Lengths = NDArray[np.float64]


class Planner:
    """Ways of a rover through a world whose hazards, steps and slopes are known.

    Args:
        world: What is driven through.
        rover: Its half width, slope and step limit say where it passes.
        slope_limit: Steepest slope of a way [rad]; None for the rover's own.

    Raises:
        UsageError: The world is larger than LARGEST.

    Attributes:
        clearance: Distance of each cell from what the rover cannot drive on [m], shape (rows, columns).
    """

    def __init__(self, world: World, rover: RoverSpec, slope_limit: float | None = None) -> None:
        limit = rover.slope_limit if slope_limit is None else slope_limit
        if max(world.ground.half_size) > 0.5 * LARGEST:
            sides = " x ".join(f"{2.0 * half:.0f}" for half in world.ground.half_size)
            raise UsageError(
                f"the world is {sides} m large, ways are found in {LARGEST:.0f} m; is it in metres?"
            )
        cells = occupancy(world, limit, rover.step_limit, RESOLUTION)
        (x, y), (half_x, half_y) = cells.middle, cells.half_size
        self._corner = x - half_x, y - half_y
        self.clearance: Lengths = RESOLUTION * distances(cells.cells != FREE)
        self._cost = np.where(self.clearance > 0.5 * rover.width, 1.0, np.inf)
        self._latest: tuple[Point, Lengths] | None = None

    def lengths(self, start: Point) -> Lengths:
        """Returns the length of the shortest way from a point to each cell [m]; inf without one."""
        if self._latest is None or self._latest[0] != start:  # who draws a goal then asks how far it is
            cells = np.array([self.cell(start)], np.int64)
            self._latest = start, RESOLUTION * travel(self._cost, cells, np.zeros(1), STEPS)
        return self._latest[1]

    def distances(self, point: Point) -> Lengths:
        """Returns the distance of each cell's middle from a point, as the crow flies [m]."""
        (low_x, low_y), (rows, columns) = self._corner, self.clearance.shape
        x = low_x + (np.arange(columns) + 0.5) * RESOLUTION - point[0]
        y = low_y + (np.arange(rows) + 0.5) * RESOLUTION - point[1]
        return np.asarray(np.hypot(x, y[:, None]))

    def length(self, points: Sequence[Point]) -> float:
        """Returns the length of the shortest way through points [m]; UsageError if there is none."""
        legs = [float(self.lengths(a)[self.cell(b)]) for a, b in pairwise(points)]
        if not math.isfinite(math.fsum(legs)):
            raise UsageError("there is no way to the goal; give another world")
        return math.fsum(legs)

    def cell(self, point: Point) -> tuple[int, int]:
        """Returns row and column of the cell that a point lies in, or of the nearest at the edge."""
        column, row = (int((at - low) / RESOLUTION) for at, low in zip(point, self._corner, strict=True))
        rows, columns = self.clearance.shape
        return min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)

    def middle(self, row: int, column: int) -> Point:
        """Returns the middle of a cell in the world [m], to a millimetre."""
        x, y = self._corner
        return round(x + (column + 0.5) * RESOLUTION, 3), round(y + (row + 0.5) * RESOLUTION, 3)

    def is_open(self, start: Point, end: Point) -> bool:
        """Returns whether the straight line between two points leads through free cells only."""
        count = max(1, math.ceil(math.dist(start, end) / (0.5 * RESOLUTION)))
        shares = (step / count for step in range(count + 1))
        line = ((start[0] + s * (end[0] - start[0]), start[1] + s * (end[1] - start[1])) for s in shares)
        return all(self._cost[self.cell(point)] == 1.0 for point in line)
