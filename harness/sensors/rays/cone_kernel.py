"""How far the rays of a bundle go before the terrain can be in their way, compiled by numba.

Rays that are close to each other are walked together, as a cone around one of them: over blocks of the
maxima that are widened by a block to each side, so that they bound the ground below all rays of a cone
that is no wider than a block. What is left for the exact walk of heightfield_kernel begins a little
before the first block that can be hit. It is only a bound: the hits are those of the walk.

Lengths are in cells, as in heightfield_kernel.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.sensors.rays.heightfield_kernel import cell_at, edge_time, next_cell

RAYS_A_CONE = 16
FINEST_LEVEL = 1
BACK = 2.0  # cells before the bound where walks begin, so that none begins in the cell that it hits
STEEP = 1e-9  # cells a metre; steeper rays are walked one by one
WIDER = 1.0 + 1e-6  # so that rounding never costs a hit

Cone = tuple[float, float, float, float, float]
Doubles = NDArray[np.float64]


@inlined
def _heading(direction: Doubles, scale: Doubles) -> tuple[float, float, float]:
    """Where a ray goes in the plane, as a unit vector (u, v), and cells there a metre."""
    u, v = direction[0] * scale[0], direction[1] * scale[1]
    pace = math.sqrt(u * u + v * v)
    return (u / pace, v / pace, pace) if pace >= STEEP else (0.0, 0.0, pace)


@inlined
def _cone(
    directions: Doubles, rays: NDArray[np.int64], range_max: float, ranges: Doubles, scale: Doubles
) -> Cone:
    """Middle as a unit vector (u, v), least slope [w a cell], half width a cell, longest way [cells]."""
    middle, slope, squared, end = rays[rays.size // 2], math.inf, 0.0, 0.0
    du, dv, _ = _heading(directions[middle], scale)
    for i in rays:
        side_u, side_v, pace = _heading(directions[i], scale)
        if pace < STEEP:
            return 1.0, 0.0, 0.0, math.inf, 0.0
        slope = min(slope, directions[i, 2] * scale[2] / pace)
        squared = max(squared, (side_u - du) ** 2 + (side_v - dv) ** 2)
        end = max(end, min(ranges[i], range_max) * pace)
    return du, dv, slope, math.sqrt(squared) * WIDER, end


@inlined
def _clear_way(
    shape: tuple[int, int],
    widened: NDArray[np.float32],
    levels: NDArray[np.int64],
    apex: tuple[float, float, float],
    cone: Cone,
) -> float:
    """How far a cone goes before it can meet the surface [cells]; inf if it never does."""
    rows, cols = shape
    u, v, w = apex
    du, dv, slope, width, end = cone
    pace_u = 1.0 / du if du != 0.0 else math.inf
    pace_v = 1.0 / dv if dv != 0.0 else math.inf
    way, level = 0.0, levels.shape[0] - 1
    row, col = cell_at(v, rows), cell_at(u, cols)
    while 0 <= row < rows - 1 and 0 <= col < cols - 1:
        block_row, block_col = row >> level, col >> level
        way_u = edge_time(u, pace_u, block_col, level)
        way_v = edge_time(v, pace_v, block_row, level)
        leave = max(min(way_u, way_v, end), way)
        lowest = w + slope * (leave if slope < 0.0 else way)
        highest = widened[levels[level, 0] + block_row * levels[level, 1] + block_col]
        if not (width * leave <= 1 << level and lowest > highest):
            if level == FINEST_LEVEL or not width * way <= 1 << (level - 1):
                break
            level -= 1
            continue
        if leave >= end:
            return math.inf
        way = leave
        edge = u + way * du, v + way * dv
        row, col, level = next_cell(shape, (row, col), level, edge, (du, dv), way_u <= way_v)
        level = min(level, levels.shape[0] - 1)
    return way


@kernel()
def clear_ways(  # noqa: PLR0913, PLR0917 - numba takes arrays, no structures of them
    shape: tuple[int, int],
    pyramid: NDArray[np.float32],
    levels: NDArray[np.int64],
    frame: Doubles,
    origin: Doubles,
    directions: Doubles,
    order: NDArray[np.int64],
    range_max: float,
    ranges: Doubles,
    clear: Doubles,
) -> None:
    """Sets `clear` to distances [m] before which no ray meets the surface; inf for those that never do.

    A distance above 0 also means that the origin is above the surface, over the map.

    Args:
        shape: Vertices of the map, rows and columns.
        pyramid: Maxima of the blocks of each level, as cast_rays takes them.
        levels: Where a level begins in the pyramid and its blocks per row, shape (levels, 2).
        frame: World position of the map's corner and field units per metre, as cast_rays takes them.
        origin: Where the rays start in the world [m], shape (3,).
        directions: Unit vectors in the world, shape (n, 3).
        order: The rays so that those close in direction are close to each other, shape (n,).
        range_max: Where rays end [m].
        ranges: Distances [m] to what else was hit, or inf; shape (n,).
        clear: Result, shape (n,).
    """
    scale = frame[1]
    u = (origin[0] - frame[0, 0]) * scale[0]
    v = (origin[1] - frame[0, 1]) * scale[1]
    w = (origin[2] - frame[0, 2]) * scale[2]
    clear[:] = 0.0
    if not (0.0 <= u <= shape[1] - 1 and 0.0 <= v <= shape[0] - 1) or levels.shape[0] <= FINEST_LEVEL:
        return
    for first in range(0, order.size, RAYS_A_CONE):
        rays = order[first : first + RAYS_A_CONE]
        cone = _cone(directions, rays, range_max, ranges, scale)
        way = _clear_way(shape, pyramid[1], levels, (u, v, w), cone)
        if way > BACK:
            for i in rays:
                clear[i] = (way - BACK) / _heading(directions[i], scale)[2]
