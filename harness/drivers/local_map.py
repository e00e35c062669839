"""What a driver remembers of its surroundings: cells around the rover that its lidar has seen occupied.

The grid keeps the world's axes and moves with the rover in whole cells. Each scan frees the cells that
its beams cross and occupies those where they end. Kernels sum in a fixed order (harness.world.grid).
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.drivers.base import DriverContext, Observation
from harness.world.grid import STEPS, Cells, Lengths, distances, travel

CELL, SIDE = 0.05, 200  # [m] of a cell; cells along a side
GOAL_DISC = 0.4  # [m] around a goal in which a way may end

Point = tuple[float, float]


@dataclass(frozen=True)
class MapOptions:
    """What a map keeps of a scan, and what its ways cost.

    Attributes:
        marked: Range up to which a hit occupies its cell; farther away it may be the ground that a
            tilted rover looks at [m].
        cleared: Range up to which a beam frees the cells that it crosses [m].
        margin: Beside the rover, which a way keeps free [m].
        ring: Width of the ring beyond it in which a way costs more [m].
        shyness: How much more it costs there at most.
    """

    marked: float = 5.0
    cleared: float = 7.0
    margin: float = 0.03
    ring: float = 0.35
    shyness: float = 3.0


@kernel("void(b1[:,:], f8, f8, f8, f8, f4[:], f8[:], f8[:])")
def mark(
    cells: Cells,
    x: float,
    y: float,
    marked: float,
    cleared: float,
    ranges: NDArray[np.float32],
    cos: NDArray[np.float64],
    sin: NDArray[np.float64],
) -> None:
    """Frees the cells that beams cross, then occupies those where they end.

    Args:
        cells: Changed in place.
        x: Of the lidar from the grid's corner [m].
        y: Of the lidar from the grid's corner [m].
        marked: As of MapOptions [m].
        cleared: As of MapOptions [m].
        ranges: Of a scan, REP-117 [m].
        cos: Of each beam's direction in the world.
        sin: Of each beam's direction in the world.
    """
    for beam in range(len(ranges)):
        reach = ranges[beam]
        if math.isnan(reach) or reach < 0.0:
            continue
        steps = int(min(reach - CELL, cleared) / CELL)
        for step in range(steps):
            column = int((x + step * CELL * cos[beam]) / CELL)
            row = int((y + step * CELL * sin[beam]) / CELL)
            if not (0 <= row < SIDE and 0 <= column < SIDE):
                break
            cells[row, column] = False
    for beam in range(len(ranges)):
        reach = ranges[beam]
        if reach <= marked and reach > 0.0:
            column = int((x + reach * cos[beam]) / CELL)
            row = int((y + reach * sin[beam]) / CELL)
            if 0 <= row < SIDE and 0 <= column < SIDE:
                cells[row, column] = True


class LocalMap:
    """Occupied cells around a rover, and ways through the others.

    Args:
        context: Of the driver that has it.
        options: What it keeps and what its ways cost.

    Attributes:
        corner: Of the grid in the world [m].
        clearance: Of each cell, its distance from an occupied one [m], shape (SIDE, SIDE); as `plan`
            found it, as `to_go` is.
        to_go: Cost of the way from each cell to the goal, about its length [m]; inf without one.
    """

    def __init__(self, context: DriverContext, options: MapOptions) -> None:
        rover = context.rover
        self._bearings = context.bearings
        self._mount = rover.lidar_x, rover.lidar_y
        self._options, self._half_width = options, 0.5 * rover.width + options.margin
        self._cells: Cells = np.zeros((SIDE, SIDE), np.bool_)
        self._at: tuple[int, int] | None = None  # cells of the corner from the world's origin
        self.clearance: Lengths = np.full((SIDE, SIDE), math.inf)
        self.to_go: Lengths = np.full((SIDE, SIDE), math.inf)

    @property
    def corner(self) -> Point:
        """Where the grid begins in the world [m]."""
        column, row = self._at or (0, 0)
        return column * CELL, row * CELL

    def see(self, observation: Observation) -> None:
        """Takes a scan, seen from where the rover is."""
        self._follow(observation.x, observation.y)
        if observation.ranges is None:
            return
        ahead, left = math.cos(observation.yaw), math.sin(observation.yaw)
        (x, y), (corner_x, corner_y) = self._mount, self.corner
        angles = self._bearings + observation.yaw
        mark(
            self._cells,
            observation.x + ahead * x - left * y - corner_x,
            observation.y + left * x + ahead * y - corner_y,
            self._options.marked,
            self._options.cleared,
            observation.ranges,
            np.cos(angles),
            np.sin(angles),
        )

    def plan(self, here: Point, goal: Point) -> None:
        """Finds the ways to a goal [m] from all cells, and how much room there is."""
        self.clearance = CELL * distances(self._cells)
        shyness, half_width = self._options.shyness, self._half_width
        room = np.maximum(0.0, 1.0 - (self.clearance - half_width) / self._options.ring)
        cost = np.where(self.clearance > half_width, 1.0 + shyness * room * room, np.inf)
        row, column = self.cell(here)
        reach = math.ceil(half_width / CELL)
        own = np.s_[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
        cost[own] = np.minimum(cost[own], 4.0 * shyness)  # it stands there: there must be a way out
        ends, begin = self._ends(goal, cost)
        self.to_go = CELL * travel(cost, ends, begin / CELL, STEPS)

    def cell(self, point: Point) -> tuple[int, int]:
        """Returns row and column of a point, or of the nearest cell at the edge."""
        x, y = self.corner
        row, column = int((point[1] - y) // CELL), int((point[0] - x) // CELL)
        return min(max(row, 0), SIDE - 1), min(max(column, 0), SIDE - 1)

    def _ends(self, goal: Point, cost: Lengths) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Cells where a way may end, and the length that is left from there [m].

        These are the free ones around the goal, else, if it is off the grid or closed in, the edge's.
        """
        x, y = self.corner
        middles = (np.arange(SIDE) + 0.5) * CELL
        left = np.hypot(x + middles[None, :] - goal[0], y + middles[:, None] - goal[1])
        ends = np.isfinite(cost) & (left < GOAL_DISC)
        if not ends.any():
            edge = np.ones((SIDE, SIDE), np.bool_)
            edge[1:-1, 1:-1] = False
            ends = np.isfinite(cost) & edge
        return np.argwhere(ends).astype(np.int64), left[ends]

    def _follow(self, x: float, y: float) -> None:
        """Moves the grid so that a point lies in its middle; what leaves it is forgotten."""
        at = int(x // CELL) - SIDE // 2, int(y // CELL) - SIDE // 2
        if self._at is not None and at != self._at:
            right, up = at[0] - self._at[0], at[1] - self._at[1]
            kept = np.zeros_like(self._cells)
            if max(abs(right), abs(up)) < SIDE:
                rows, columns = _overlap(up), _overlap(right)
                kept[rows[1], columns[1]] = self._cells[rows[0], columns[0]]
            self._cells = kept
        self._at = at


def _overlap(shift: int) -> tuple[slice, slice]:
    """What remains of a side when the grid moves by some cells: from where, to where."""
    return slice(max(shift, 0), SIDE + min(shift, 0)), slice(max(-shift, 0), SIDE - max(shift, 0))
