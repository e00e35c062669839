"""Where vertical lines through a grid's vertices cross triangles, and on which of these one can stand.

A line is followed upwards. The first surface that faces up is a floor. What faces down is a ceiling:
with HEADROOM below it the floor stays; with less, nothing gets in between, and the next surface that
faces up is the floor instead. A second floor without a ceiling in between is a sheet, and a ceiling too.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Field
from harness.world.obstacles import HEADROOM

CHUNK = 4_000_000  # vertices that are looked at at a time
ON_EDGE = 1e-9  # of a barycentric coordinate: what lies on an edge belongs to both sides


@dataclass(frozen=True)
class Grid:
    """Vertices `cell` metres apart, the first of them at x, y [m]."""

    x: float
    y: float
    cell: float
    rows: int
    columns: int

    @property
    def middle(self) -> tuple[float, float]:
        """Its middle in the world [m]."""
        return (
            self.x + 0.5 * self.cell * (self.columns - 1),
            self.y + 0.5 * self.cell * (self.rows - 1),
        )


@dataclass(frozen=True, eq=False)
class Crossings:
    """Crossings, one per entry, by vertex, from below; at equal height what faces down comes first."""

    vertex: NDArray[np.int64]  # index into the flat grid
    triangle: NDArray[np.int64]  # which is crossed there
    height: Field  # [m]
    faces_up: NDArray[np.bool_]  # whether it is crossed from within to the outside


def crossings(corners: NDArray[np.float64], grid: Grid) -> Crossings:
    """Returns all crossings of triangles, shape (f, 3, 3), with a grid's vertical lines."""
    flat = np.ascontiguousarray((corners[:, :, :2] - (grid.x, grid.y)) / grid.cell)
    low = np.ceil(flat.min(axis=1) - ON_EDGE).astype(np.int64).clip(0)
    most = (grid.columns - 1, grid.rows - 1)
    high = np.minimum(np.floor(flat.max(axis=1) + ON_EDGE).astype(np.int64), most)
    area = _cross(flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0])
    extent = (high - low + 1).clip(0)
    count = np.where(np.abs(area) > ON_EDGE, extent[:, 0] * extent[:, 1], 0)
    ends = np.cumsum(count)
    parts = []
    start = 0
    while start < len(count):
        before = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, before + CHUNK)))
        parts.append(_inside(np.arange(start, stop), count, (low, extent, flat, area), corners, grid))
        start = stop
    nothing = np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0)
    vertex, triangle, height = (np.concatenate(part) for part in zip(nothing, *parts, strict=True))
    faces_up = area[triangle] > 0.0
    order = np.lexsort((faces_up, height, vertex))
    return Crossings(vertex[order], triangle[order], height[order], faces_up[order])


def _inside(
    chosen: NDArray[np.int64],
    count: NDArray[np.int64],
    shapes: tuple[NDArray[np.int64], NDArray[np.int64], Field, Field],
    corners: NDArray[np.float64],
    grid: Grid,
) -> tuple[NDArray[np.int64], NDArray[np.int64], Field]:
    """Vertices inside of some triangles, these, and the heights there; bounding boxes are searched."""
    low, extent, flat, area = shapes
    triangle = np.repeat(chosen, count[chosen])
    first = np.cumsum(count[chosen]) - count[chosen]
    place = np.arange(len(triangle)) - np.repeat(first, count[chosen])
    column = low[triangle, 0] + place % extent[triangle, 0]
    row = low[triangle, 1] + place // extent[triangle, 0]
    here = np.column_stack([column, row])
    a, b, c = (flat[triangle, corner] - here for corner in range(3))
    weights = np.column_stack([_cross(b, c), _cross(c, a), _cross(a, b)]) / area[triangle, None]
    is_inside = (weights >= -ON_EDGE).all(axis=1)
    triangle, weights = triangle[is_inside], weights[is_inside]
    heights = (weights * corners[triangle, :, 2]).sum(axis=1)
    return row[is_inside] * grid.columns + column[is_inside], triangle, heights


def _cross(one: Field, other: Field) -> Field:
    return np.asarray(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])


def floors(crossed: Crossings, grid: Grid, plane: float | None) -> Field:
    """Returns the height on which one stands at each vertex [m], NaN without, shape (rows, columns).

    Args:
        crossed: Of the ground's triangles.
        grid: Whose lines cross them.
        plane: Height of a plane without end that is solid below [m]: what rises above it is solid too.
    """
    floor = np.full(grid.rows * grid.columns, np.nan if plane is None else plane)
    is_plane = np.full(floor.size, plane is not None)
    below_ceiling, is_settled = np.zeros_like(is_plane), np.zeros_like(is_plane)
    starts = np.searchsorted(crossed.vertex, np.arange(floor.size))
    counts = np.searchsorted(crossed.vertex, np.arange(floor.size), side="right") - starts
    for level in range(int(counts.max(initial=0))):
        at = np.flatnonzero((counts > level) & ~is_settled)
        crossing = starts[at] + level
        height, faces_up = crossed.height[crossing], crossed.faces_up[crossing]
        gap = height - floor[at]
        is_above = ~(gap < 0.0)  # the first one too, whose gap is NaN
        has_room = (gap >= HEADROOM) & ~(is_plane[at] & faces_up) & ~below_ceiling[at]
        is_settled[at[has_room]] = True
        below_ceiling[at[~faces_up & is_above & ~np.isnan(gap)]] = True
        rises = at[faces_up & is_above & ~has_room]
        floor[rises] = height[faces_up & is_above & ~has_room]
        below_ceiling[rises] = is_plane[rises] = False
    return floor.reshape(grid.rows, grid.columns)
