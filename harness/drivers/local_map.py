"""What a driver remembers of its surroundings: cells around the rover that its lidar has seen occupied.

The grid keeps the world's axes and moves with the rover in whole cells. Each scan frees the cells that
its beams cross and occupies those where they end. Kernels sum in a fixed order (harness.world.grid).
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.drivers.base import DriverContext, Observation
from harness.world.grid import STEPS, Cells, Lengths, distances, travel

CELL, SIDE = 0.05, 200  # [m] of a cell; cells along a side
MARKED = 5.0  # [m]: what is hit farther away may be the ground that a tilted rover looks at
CLEARED = 7.0  # [m] along a beam that hits nothing
MARGIN = 0.03  # [m] beside the rover that a way keeps free
SHY, SHYNESS = 0.35, 3.0  # [m] around hazards in which a way costs more, and how much more
GOAL_DISC = 0.4  # [m] around a goal in which a way may end

Point = tuple[float, float]


@kernel("void(b1[:,:], f8, f8, f8, f8, f4[:], f8[:], f8[:])")
def mark(
    cells: Cells,
    corner_x: float,
    corner_y: float,
    x: float,
    y: float,
    ranges: NDArray[np.float32],
    cos: NDArray[np.float64],
    sin: NDArray[np.float64],
) -> None:
    """Frees the cells that beams cross, then occupies those where they end.

    Args:
        cells: Changed in place.
        corner_x: Of the grid in the world [m].
        corner_y: Of the grid in the world [m].
        x: Of the lidar in the world [m].
        y: Of the lidar in the world [m].
        ranges: Of a scan, REP-117 [m].
        cos: Of each beam's direction in the world.
        sin: Of each beam's direction in the world.
    """
    for beam in range(len(ranges)):
        reach = ranges[beam]
        if math.isnan(reach) or reach < 0.0:
            continue
        steps = int(min(reach - CELL, CLEARED) / CELL)
        for step in range(steps):
            column = int((x + step * CELL * cos[beam] - corner_x) / CELL)
            row = int((y + step * CELL * sin[beam] - corner_y) / CELL)
            if not (0 <= row < SIDE and 0 <= column < SIDE):
                break
            cells[row, column] = False
    for beam in range(len(ranges)):
        reach = ranges[beam]
        if reach <= MARKED and reach > 0.0:
            column = int((x + reach * cos[beam] - corner_x) / CELL)
            row = int((y + reach * sin[beam] - corner_y) / CELL)
            if 0 <= row < SIDE and 0 <= column < SIDE:
                cells[row, column] = True


class LocalMap:
    """Occupied cells around a rover, and ways through the others.

    Args:
        context: Of the driver that has it.

    Attributes:
        corner: Of the grid in the world [m].
        clearance: Of each cell, its distance from an occupied one [m], shape (SIDE, SIDE); as `plan`
            found it, as `to_go` is.
        to_go: Cost of the way from each cell to the goal, about its length [m]; inf without one.
    """

    def __init__(self, context: DriverContext) -> None:
        rover = context.rover
        self._bearings = context.bearings
        self._mount = rover.lidar_x, rover.lidar_y
        self._half_width = 0.5 * rover.width + MARGIN
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
        x, y = self._mount
        angles = self._bearings + observation.yaw
        mark(
            self._cells,
            *self.corner,
            observation.x + ahead * x - left * y,
            observation.y + left * x + ahead * y,
            observation.ranges,
            np.cos(angles),
            np.sin(angles),
        )

    def plan(self, here: Point, goal: Point) -> None:
        """Finds the ways to a goal [m] from all cells, and how much room there is."""
        self.clearance = CELL * distances(self._cells)
        room = np.maximum(0.0, 1.0 - (self.clearance - self._half_width) / SHY)
        cost = np.where(self.clearance > self._half_width, 1.0 + SHYNESS * room * room, np.inf)
        row, column = self.cell(here)
        reach = math.ceil(self._half_width / CELL)
        own = np.s_[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1]
        cost[own] = np.minimum(cost[own], 4.0 * SHYNESS)  # it stands there: there must be a way out
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
