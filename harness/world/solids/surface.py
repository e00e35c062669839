"""The ground's triangles -> a heightfield, what of them it shows and how well, and what is left over.

What no floor is under (beyond the outline of a mesh, or in a hole of it) is a pit, PIT below the lowest
floor: a rover falls, as it would in Gazebo. Small gaps are filled.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label, maximum_filter

from harness.base.errors import UsageError
from harness.base.mesh import Mesh, areas_and_normals
from harness.spec.world import LARGEST_MAP, SMALLEST_MAP
from harness.world.heightfield import Field, Heightfield, filled, finest_cell
from harness.world.solids.columns import Crossings, Grid, crossings, floors
from harness.world.terrain import HEIGHT_DECIMALS

CELL = 0.1  # [m], as the named terrains have
ROUNDING = 1e-6  # [m] by which a length may differ once it lies somewhere
PIT = 2.0  # [m] below the lowest floor
LARGEST_GAP = 0.25  # [m2] that is filled
TOLERANCE = 0.05  # [m] above the heightfield up to which it shows a triangle
STEEPEST_MEASURED = math.radians(45.0)  # heights of what is steeper say little: they are all along it
BLOCK = 1.0  # [m]: how finely the room between pits is measured
EDGE = 3.0  # rise within a cell, in cells, from which on it holds an edge
# Corners, middles of the edges and the middle, in barycentric coordinates.
SAMPLES = (
    np.array([[6, 0, 0], [0, 6, 0], [0, 0, 6], [3, 3, 0], [0, 3, 3], [3, 0, 3], [2, 2, 2]], np.float64)
    / 6.0
)

Bounds = tuple[float, float, float, float]  # x from, x to, y from, y to [m]


@dataclass(frozen=True, eq=False)
class Surface:
    """A heightfield made of triangles."""

    ground: Heightfield
    left_over: NDArray[np.bool_]  # which triangles it does not show, shape (f,)
    has_floor: NDArray[np.bool_]  # where there is one, shape (rows, columns)


def chosen_grid(bounds: Bounds, cell: float | None) -> Grid:
    """Returns vertices within bounds, around their middle; UsageError if that cannot be driven.

    They are `cell` metres apart; by default CELL, or as much more as the map needs.
    """
    width, depth = bounds[1] - bounds[0], bounds[3] - bounds[2]
    smallest, largest = SMALLEST_MAP - ROUNDING, LARGEST_MAP + ROUNDING
    if not smallest <= min(width, depth) <= max(width, depth) <= largest:
        raise UsageError(
            f"it is {width:.4g} x {depth:.4g} m; between {SMALLEST_MAP:g} and {LARGEST_MAP:g} m can "
            "be driven; --mesh-unit gives the unit of a mesh"
        )
    least = finest_cell(width, depth)
    if cell is not None and cell < least:
        raise UsageError(
            f"cells of {cell:g} m are too many on {width:.4g} x {depth:.4g} m; give --terrain-cell "
            f"{math.ceil(least * 1000) / 1000:g} or more"
        )
    step = cell or max(CELL, least)
    columns, rows = (math.floor(length / step + 1e-6) + 1 for length in (width, depth))
    x, y = (
        0.5 * (low + high - step * (count - 1))
        for low, high, count in ((*bounds[:2], columns), (*bounds[2:], rows))
    )
    return Grid(x, y, step, rows, columns)


def surface_of(mesh: Mesh, grid: Grid, plane: float | None, notes: list[str]) -> Surface:
    """Returns the heightfield of the ground; UsageError if nothing of it faces up.

    Args:
        mesh: The ground's triangles; none where there is only a plane.
        grid: The vertices.
        plane: Height of a plane without end [m], if there is one.
        notes: Takes what was done, and how well it fits.
    """
    crossed = crossings(mesh.corners, grid)
    heights = floors(crossed, grid, plane)
    has_floor = ~np.isnan(heights)
    if not has_floor.any():
        raise UsageError("nothing of it faces up: there is no ground to drive on")
    heights = np.round(_closed(heights, grid, notes), HEIGHT_DECIMALS) + 0.0
    left_over = _left_over(mesh, crossed, heights, grid)
    ground = Heightfield(heights, grid.cell, grid.middle)
    is_shown = ~left_over
    is_buried = crossed.height < heights.ravel()[crossed.vertex] - TOLERANCE
    is_shown[crossed.triangle[is_buried]] = False
    _note_error(mesh.corners[is_shown], ground, has_floor, notes)
    return Surface(ground, left_over, has_floor)


def _closed(heights: Field, grid: Grid, notes: list[str]) -> Field:
    """Heights everywhere: small gaps filled, pits elsewhere."""
    missing = np.isnan(heights)
    if not missing.any():
        return heights
    names, _ = label(missing)
    areas = np.bincount(names.ravel()) * grid.cell**2
    edge = np.concatenate([names[0], names[-1], names[:, 0], names[:, -1]])
    is_pit = areas > LARGEST_GAP
    is_pit[edge] = True
    is_pit[0] = False
    holes = np.setdiff1d(np.flatnonzero(is_pit), edge)
    pit = is_pit[names]
    lowest = float(np.nanmin(heights)) - PIT
    closed = np.where(pit, lowest, filled(heights))
    if holes.size:
        notes.append(
            f"{holes.size} holes without any surface, the largest of {areas[holes].max():.4g} m2: pits"
        )
    if (missing & ~pit).any():
        notes.append(
            f"{(missing & ~pit).mean():.2%} of the map filled from its surroundings: small gaps"
        )
    if pit.any():
        notes.append(
            f"{pit.mean():.1%} of the map has no surface: a pit there, {PIT:g} m below the lowest point"
        )
    return closed


def _left_over(mesh: Mesh, crossed: Crossings, heights: Field, grid: Grid) -> NDArray[np.bool_]:
    """Triangles that reach above the heightfield: at vertices, or at samples above all that is near."""
    left_over = np.zeros(len(mesh.faces), np.bool_)
    left_over[crossed.triangle[crossed.height > heights.ravel()[crossed.vertex] + TOLERANCE]] = True
    points = SAMPLES @ mesh.corners  # (f, 7, 3)
    around = maximum_filter(heights, 3)
    column, row = (
        np.rint((points[..., axis] - start) / grid.cell).astype(int).clip(0, count - 1)
        for axis, start, count in ((0, grid.x, grid.columns), (1, grid.y, grid.rows))
    )
    left_over |= (points[..., 2] > around[row, column] + TOLERANCE).any(axis=1)
    return left_over


def _note_error(
    corners: NDArray[np.float64], ground: Heightfield, has_floor: NDArray[np.bool_], notes: list[str]
) -> None:
    """Compares heights at the triangles' samples, but for cells next to an edge, which none can show."""
    _, normals = areas_and_normals(corners)
    gentle = corners[normals[:, 2] > math.cos(STEEPEST_MEASURED)]
    points = (SAMPLES @ gentle).reshape(-1, 3)
    points = points[on_map(points, ground)]
    low = (points[:, :2] - ground.bounds()[::2]) / ground.cell
    column, row = (low[:, axis].astype(int).clip(0, has_floor.shape[1 - axis] - 2) for axis in (0, 1))
    windows = np.lib.stride_tricks.sliding_window_view
    is_edge = np.ptp(windows(ground.heights, (2, 2)), axis=(2, 3)) > EDGE * ground.cell
    is_edge |= ~windows(has_floor, (2, 2)).all(axis=(2, 3))
    is_edge = maximum_filter(is_edge, 3)
    x, y, z = points[~is_edge[row, column]].T
    if not x.size:
        return
    errors = np.abs(ground.heights_at(x, y) - z)
    notes.append(
        f"heights differ from the mesh by {errors.max():.2g} m at most, 99 % of them by less than "
        f"{np.quantile(errors, 0.99):.2g} m (but next to edges, and where it is steeper than 45 deg)"
    )


def on_map(points: NDArray[np.float64], ground: Heightfield) -> NDArray[np.bool_]:
    """Returns which points, shape (n, 3), are above or below the map."""
    return np.asarray((np.abs(points[:, :2] - ground.middle) <= ground.half_size).all(axis=1))


def room_without_pits(surface: Surface) -> Bounds | None:
    """Returns the largest rectangle without pits; None if there are none at all."""
    if surface.has_floor.all():
        return None
    ground = surface.ground
    step = max(1, round(BLOCK / ground.cell))
    rows, columns = (count // step for count in surface.has_floor.shape)
    blocks = surface.has_floor[: rows * step, : columns * step].reshape(rows, step, columns, step)
    top, bottom, left, right = largest_rectangle(np.asarray(blocks.all(axis=(1, 3))))
    x, _, y, _ = ground.bounds()
    width = step * ground.cell
    return x + left * width, x + right * width, y + top * width, y + bottom * width


def largest_rectangle(free: NDArray[np.bool_]) -> tuple[int, int, int, int]:
    """Returns the largest rectangle that is true everywhere: first and end row, first and end column."""
    best, area = (0, 1, 0, 1), 0
    heights = np.zeros(free.shape[1] + 1, int)
    for row, line in enumerate(free):
        heights[:-1] = np.where(line, heights[:-1] + 1, 0)
        open_from: list[tuple[int, int]] = []  # column from which on it is at least that high
        for column, height in enumerate(heights.tolist()):
            begin = column
            while open_from and open_from[-1][1] >= height:
                begin, tall = open_from.pop()
                if tall * (column - begin) > area:
                    best, area = (row + 1 - tall, row + 1, begin, column), tall * (column - begin)
            open_from.append((begin, height))
    return best
