"""The world as navigation sees it: which cells a rover can stand on and which it cannot.

Occupied is what a hazard covers, what a rock covers that is higher than the rover climbs, what is
steeper or steps higher than that, and the edge of the map, where a run ends. What is higher above the
ground than HEADROOM is not in the way. All other cells are free:
nothing is unknown to the simulator.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import EDGE_MARGIN, Heightfield
from harness.world.obstacles import HEADROOM, Obstacle, ObstacleKind, bottom, outline, top
from harness.world.statistics import WINDOW, averaged, rises, steepness
from harness.world.world import World

RESOLUTION = 0.05  # [m], Nav2's default of its costmaps
FREE, OCCUPIED = 0, 100

Mask = NDArray[np.bool_]
Places = NDArray[np.float64]  # the middles of rows or of columns of cells [m]


@dataclass(frozen=True, eq=False)
class OccupancyMap:
    """Cells in rows with +y and columns with +x, as nav_msgs/OccupancyGrid orders them."""

    cells: NDArray[np.int8]  # FREE or OCCUPIED, int8, shape (rows, columns)
    resolution: float  # side length of a cell [m]
    half_size: tuple[float, float]  # half the lengths of the map along x and y [m]
    middle: tuple[float, float] = (0.0, 0.0)  # of the map, in the world [m]

    def is_free(self, x: float, y: float, radius: float = 0.0) -> bool:
        """Returns whether no cell is occupied whose middle lies in a disc, nor the one at its middle.

        Args:
            x: Of the disc's middle [m]; a point off the map is not free.
            y: Of the disc's middle [m].
            radius: Of the disc [m].
        """
        half_x, half_y = self.half_size
        x, y = x - self.middle[0], y - self.middle[1]
        if not (abs(x) < half_x and abs(y) < half_y):  # so that NaN is not
            return False
        row, column = int((y + half_y) / self.resolution), int((x + half_x) / self.resolution)
        middles_x, middles_y = (middles(half, self.resolution) for half in self.half_size)
        inside = np.hypot(middles_y[:, None] - y, middles_x - x) <= radius
        inside[row, column] = True
        return bool((self.cells[inside] == FREE).all())


def occupancy(
    world: World, slope_limit: float, step_limit: float, resolution: float = RESOLUTION
) -> OccupancyMap:
    """Returns the map of a world for a rover.

    Args:
        world: What is mapped.
        slope_limit: Steepest slope that the rover climbs, of the ground averaged over 0.3 m [rad].
        step_limit: Highest step that it climbs [m].
        resolution: Side length of a cell [m].
    """
    ground = world.ground
    centred = middles(ground.half_size[0], resolution), middles(ground.half_size[1], resolution)
    blocked = _on_cells(_impassable(ground, slope_limit, step_limit), ground, centred, resolution)
    places = centred[0] + ground.middle[0], centred[1] + ground.middle[1]
    for obstacle in world.obstacles:
        x, y, _ = obstacle.position
        level = ground.height_at(x, y)
        if obstacle.kind is ObstacleKind.DECK or bottom(obstacle) - level > HEADROOM:
            continue
        if obstacle.kind is ObstacleKind.HAZARD or top(obstacle) - level > step_limit:
            window, inside = covered(obstacle, places, resolution)
            blocked[window] |= inside
    at_edge_x, at_edge_y = (
        np.abs(places) > half - EDGE_MARGIN
        for places, half in zip(centred, ground.half_size, strict=True)
    )
    blocked |= at_edge_x | at_edge_y[:, None]
    cells = np.where(blocked, OCCUPIED, FREE).astype(np.int8)
    return OccupancyMap(cells, resolution, ground.half_size, ground.middle)


def middles(half_size: float, resolution: float) -> Places:
    """Returns the middles of rows or columns from the middle of the map [m]."""
    count = math.ceil(2 * half_size / resolution - 1e-9)
    return np.asarray((np.arange(count) + 0.5) * resolution - half_size)


def _impassable(ground: Heightfield, slope_limit: float, step_limit: float) -> Mask:
    """Vertices that are too steep, or beside a step that is too high.

    A step is what rises from a vertex to the next by more than `step_limit` above the steepest slope.
    """
    steep = steepness(averaged(ground, WINDOW), ground.cell) > math.tan(slope_limit)
    return np.asarray(steep | (rises(ground.heights) > step_limit + ground.cell * math.tan(slope_limit)))


def _on_cells(
    vertices: Mask, ground: Heightfield, middles: tuple[Places, Places], resolution: float
) -> Mask:
    """Cells whose nearest vertex is marked, or in which a marked one lies."""
    nearest_x, nearest_y = (
        np.rint((places + half) / ground.cell).astype(int).clip(0, most - 1)
        for places, half, most in zip(middles, ground.half_size, vertices.T.shape, strict=True)
    )
    cells: Mask = vertices[np.ix_(nearest_y, nearest_x)]
    own = (np.nonzero(vertices)[axis] * (ground.cell / resolution) for axis in (0, 1))
    rows, columns = (
        (place + 1e-9).astype(int).clip(0, most - 1)
        for place, most in zip(own, cells.shape, strict=True)
    )
    cells[rows, columns] = True
    return cells


def covered(
    obstacle: Obstacle, middles: tuple[Places, ...], resolution: float
) -> tuple[tuple[NDArray[np.intp], ...], Mask]:
    """Returns a window of cells, and which of them an obstacle overlaps: no axis separates the two.

    Args:
        obstacle: A convex shape, seen from above.
        middles: Of the columns and of the rows, in the world [m].
        resolution: Side length of a cell [m].
    """
    corners = outline(obstacle)
    low, high = corners.min(axis=0) - resolution / 2, corners.max(axis=0) + resolution / 2
    columns, rows = (np.nonzero((low[i] <= middles[i]) & (middles[i] <= high[i]))[0] for i in (0, 1))
    edges = np.roll(corners, -1, axis=0) - corners
    differ = edges.any(axis=1)  # a hull of few corners has many of them several times
    corners, edges = corners[differ], edges[differ]
    outward_x, outward_y = edges[:, 1:], -edges[:, :1]  # the corners go round counter-clockwise
    reach_of_cell = (np.abs(outward_x) + np.abs(outward_y)) * resolution / 2
    x, y = middles[0][columns] - corners[:, :1], middles[1][rows] - corners[:, 1:]
    beyond = (outward_x * x)[:, None] + (outward_y * y)[:, :, None]  # by edge, row, column
    inside: Mask = np.asarray((beyond <= reach_of_cell[:, None]).all(axis=0))
    return np.ix_(rows, columns), inside
