"""The exact walk of rays over a heightfield, compiled by numba.

It works in field units: u counts cells along x from the map's corner, v cells along y, w is in the
unit of the stored heights (0 lowest, 1 highest); t stays the distance along the ray [m].

The solid is MuJoCo's: two triangles per cell split along (row, col)-(row+1, col+1), side walls from
w = 0 up to the edge of the surface, and below w = 0 a box with six faces. All can be hit from both
sides. A ray's clearance over the surface is continuous from cell to cell and linear in t over a
triangle, so a hit is where it changes sign: no ray slips through between two triangles.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel

MISS = math.inf
NEAR_LEVEL = 3  # where a walk begins that is not far from its end

Ray = tuple[float, float, float, float, float, float]  # u, v, w and their change per metre
Interval = tuple[float, float]  # of t; empty if its begin lies behind its end


@inlined
def slab(start: float, speed: float, low: float, high: float) -> Interval:
    """Returns where along a ray one coordinate lies within low..high."""
    if speed == 0.0:
        if low <= start <= high:
            return -math.inf, math.inf
        return math.inf, -math.inf
    one, other = (low - start) / speed, (high - start) / speed
    return min(one, other), max(one, other)


@inlined
def _over_map(heights: NDArray[np.float32], ray: Ray) -> Interval:
    """Where a ray is above, in or below the map, ahead of its origin or behind it."""
    begin_u, end_u = slab(ray[0], ray[3], 0.0, heights.shape[1] - 1.0)
    begin_v, end_v = slab(ray[1], ray[4], 0.0, heights.shape[0] - 1.0)
    return max(begin_u, begin_v), min(end_u, end_v)


@inlined
def _hit_base(ray: Ray, over_map: Interval, bottom: float) -> float:
    """First t >= 0 on a face of the base box, from outside or from within."""
    begin, end = slab(ray[2], ray[5], bottom, 0.0)
    begin, end = max(begin, over_map[0]), min(end, over_map[1])
    if begin > end or end < 0.0:
        return MISS
    return begin if begin >= 0.0 else end


@inlined
def cell_at(position: float, vertices: int) -> int:
    """Row or column of the cell that holds a position on the map."""
    return min(max(int(position), 0), vertices - 2)


@inlined
def _clearance(heights: NDArray[np.float32], ray: Ray, t: float) -> float:
    """Height of a point of the ray over the surface."""
    u, v, w = ray[0] + t * ray[3], ray[1] + t * ray[4], ray[2] + t * ray[5]
    row, col = cell_at(v, heights.shape[0]), cell_at(u, heights.shape[1])
    a, b = u - col, v - row
    near, far = heights[row, col], heights[row + 1, col + 1]
    corner = heights[row, col + 1] if a >= b else heights[row + 1, col]
    return float(w - (near + (corner - near) * max(a, b) + (far - corner) * min(a, b)))


@inlined
def _hit_cell(
    heights: NDArray[np.float32], row: int, col: int, ray: Ray, stay: Interval, side: float
) -> float:
    """First t of the stay in a cell at which the clearance is no longer on `side` (+1 or -1)."""
    u, v, w, du, dv, dw = ray
    # As float32: numba's float() would leave them so, Python's would not, and the bits would differ.
    near, far = heights[row, col], heights[row + 1, col + 1]
    right, left = heights[row, col + 1], heights[row + 1, col]
    a, b = u - col, v - row
    # Clearance over the planes of the two triangles, each as start + rate * t.
    start = w - (near + (right - near) * a + (far - right) * b)
    rate = dw - ((right - near) * du + (far - right) * dv)
    other_start = w - (near + (left - near) * b + (far - left) * a)
    other_rate = dw - ((left - near) * dv + (far - left) * du)
    begin, end = stay
    off_diagonal, drift = a - b, du - dv
    at_begin, at_end = off_diagonal + drift * begin, off_diagonal + drift * end
    if at_begin < 0.0 or (at_begin == 0.0 and at_end < 0.0):
        start, rate, other_start, other_rate = other_start, other_rate, start, rate
    crossing = end
    if at_begin * at_end < 0.0:
        crossing = min(max(-off_diagonal / drift, begin), end)
    before: float = side * (start + rate * begin)
    if before <= 0.0:
        return begin
    after: float = side * (start + rate * crossing)
    if after <= 0.0:
        return begin + (crossing - begin) * (before / (before - after))
    if crossing < end:
        last: float = side * (other_start + other_rate * end)
        if last <= 0.0:
            return crossing + (end - crossing) * (after / (after - last))
    return MISS


@inlined
def edge_time(start: float, pace: float, block: int, level: int) -> float:
    """Where a ray leaves a block of 2**level cells along one axis; `pace` in metres per cell."""
    if math.isinf(pace):
        return math.inf
    return (((block + (pace > 0.0)) << level) - start) * pace


@inlined
def next_cell(
    shape: tuple[int, int],
    cell: tuple[int, int],
    level: int,
    edge: tuple[float, float],
    speed: tuple[float, float],
    along_u: bool,
) -> tuple[int, int, int]:
    """Row and column of the cell in which a ray is that leaves its block of 2**level cells.

    Args:
        shape: Vertices of the map, rows and columns.
        cell: Row and column of a cell of the block.
        level: Of the block.
        edge: Where it leaves the block, (u, v).
        speed: Change of u and v.
        along_u: Whether it leaves through an edge of constant u.

    Returns:
        Row, column, and level: one coarser where it comes into another parent block.
    """
    size = 1 << level
    if along_u:
        first = cell[0] >> level << level  # rounding might leave the block
        row = min(max(int(edge[1]), first), first + size - 1, shape[0] - 2)
        col = (cell[1] >> level << level) + (size if speed[0] > 0.0 else -1)
        climb = (col ^ cell[1]) >> (level + 1)
    else:
        first = cell[1] >> level << level
        col = min(max(int(edge[0]), first), first + size - 1, shape[1] - 2)
        row = (cell[0] >> level << level) + (size if speed[1] > 0.0 else -1)
        climb = (row ^ cell[0]) >> (level + 1)
    return row, col, level + 1 if climb else level


@inlined
def _hit_surface(
    heights: NDArray[np.float32],
    maxima: NDArray[np.float32],
    levels: NDArray[np.int64],
    ray: Ray,
    stay: Interval,
    side: float,
    level: int,
) -> float:
    """Amanatides-Woo over blocks of 2**level cells, first of those of a level.

    A block whose maximum the ray stays above is skipped whole, another is entered one level finer;
    a ray that steps into another parent block climbs one level. From below every cell is visited.
    """
    rows, cols = heights.shape
    u, v, w, du, dv, dw = ray
    pace_u = 1.0 / du if du != 0.0 else math.inf
    pace_v = 1.0 / dv if dv != 0.0 else math.inf
    t, t_end = stay
    row, col = cell_at(v + t * dv, rows), cell_at(u + t * du, cols)
    top = levels.shape[0] - 1 if side > 0.0 else 0
    while 0 <= row < rows - 1 and 0 <= col < cols - 1:
        block_row, block_col = row >> level, col >> level
        t_u = edge_time(u, pace_u, block_col, level)
        t_v = edge_time(v, pace_v, block_row, level)
        leave = max(min(t_u, t_v, t_end), t)
        if level > 0:
            lowest = w + dw * (leave if dw < 0.0 else t)
            if lowest <= maxima[levels[level, 0] + block_row * levels[level, 1] + block_col]:
                level -= 1
                continue
        else:
            hit = _hit_cell(heights, row, col, ray, (t, leave), side)
            if hit < MISS:
                return hit
        if leave >= t_end:
            break
        t = leave
        edge, speed = (u + t * du, v + t * dv), (du, dv)
        row, col, level = next_cell(heights.shape, (row, col), level, edge, speed, t_u <= t_v)
        level = min(level, top)
    return MISS


@inlined
def _hit_field(
    heights: NDArray[np.float32],
    maxima: NDArray[np.float32],
    levels: NDArray[np.int64],
    extent: tuple[float, float],
    ray: Ray,
    limit: float,
) -> float:
    """First t in 0..limit at which a ray touches the solid; extent is its lowest and highest w."""
    over_map = _over_map(heights, ray)
    begin, end = max(over_map[0], 0.0), min(over_map[1], limit)
    if begin > end:
        return MISS
    w_begin = ray[2] + begin * ray[5]
    lowest = min(w_begin, ray[2] + end * ray[5])
    if lowest > extent[1]:
        return MISS
    base = _hit_base(ray, over_map, extent[0]) if lowest <= 0.0 else MISS
    end = min(end, base)
    clearance = _clearance(heights, ray, begin)
    if clearance < 0.0 and over_map[0] > 0.0 and w_begin >= 0.0:
        return begin  # a side wall, from outside
    side = 1.0 if clearance > 0.0 else -1.0
    top = levels.shape[0] - 1 if side > 0.0 else 0
    surface = _hit_surface(heights, maxima, levels, ray, (begin, end), side, top)
    if surface == MISS and side < 0.0 and end == over_map[1] and ray[2] + end * ray[5] >= 0.0:
        return end  # a side wall, from within
    return min(surface, base)


@kernel()
def cast_rays(  # noqa: PLR0913, PLR0917 - numba takes arrays, no structures of them
    heights: NDArray[np.float32],
    pyramid: NDArray[np.float32],
    levels: NDArray[np.int64],
    frame: NDArray[np.float64],
    origin: NDArray[np.float64],
    directions: NDArray[np.float64],
    clear: NDArray[np.float64],
    range_max: float,
    ranges: NDArray[np.float64],
) -> None:
    """Lowers `ranges` to the distance of the heightfield where that is nearer.

    Args:
        heights: Stored heights, shape (rows, cols), in field units.
        pyramid: Maxima of the blocks of each level, one after the other, and those of a block with its
            eight neighbours, shape (2, blocks).
        levels: Where a level begins in the pyramid and its blocks per row, shape (levels, 2).
        frame: World position [m] of u = v = w = 0, field units per metre, and (lowest w, highest w,
            unused), shape (3, 3).
        origin: Where the rays start in the world [m], shape (3,).
        directions: Unit vectors in the world, shape (n, 3).
        clear: Distances [m] before which rays do not meet the surface, as clear_ways gives them, where
            walks begin; 0 where nothing is known of them; shape (n,).
        range_max: Where rays end [m].
        ranges: Distances [m] to what else was hit, or inf; shape (n,).
    """
    su, sv, sw = frame[1, 0], frame[1, 1], frame[1, 2]
    u = (origin[0] - frame[0, 0]) * su
    v = (origin[1] - frame[0, 1]) * sv
    w = (origin[2] - frame[0, 2]) * sw
    extent, maxima = (frame[2, 0], frame[2, 1]), pyramid[0]
    near = min(NEAR_LEVEL, levels.shape[0] - 1)
    for i in range(ranges.shape[0]):
        limit = min(ranges[i], range_max)
        if clear[i] > limit:
            continue
        ray = (u, v, w, directions[i, 0] * su, directions[i, 1] * sv, directions[i, 2] * sw)
        if clear[i] > 0.0:  # it begins over the map and above the surface: no walls
            over_map = _over_map(heights, ray)
            end = min(over_map[1], limit)
            if clear[i] > end:  # it has left the map
                continue
            base = _hit_base(ray, over_map, extent[0]) if w + end * ray[5] <= 0.0 else MISS
            stay = clear[i], min(end, base)
            hit = min(_hit_surface(heights, maxima, levels, ray, stay, 1.0, near), base)
        else:
            hit = _hit_field(heights, maxima, levels, extent, ray, limit)
        if hit <= limit:
            ranges[i] = hit
