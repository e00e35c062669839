"""How far the rays of a bundle go before the terrain can be in their way, compiled by numba.

All rays of a scan start at one point. Around it the map is parted into sectors, and each sector into
rings whose width grows with their distance; the highest point of every part is looked up once in the
pyramid of maxima. A ray that stays above it passes the ring without looking at a cell. What is left
for the exact walk of heightfield_kernel begins where this ends, a little before the first cell that
can be hit. It is only a bound: the hits are those of the walk.

Lengths are in cells, as in heightfield_kernel. An angle is given as a pseudo-angle of 0 to 4 that grows
with it and costs a division.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel

SECTORS = 256  # a power of two
RINGS = 32
FIRST_RING, GROWTH = 4.0, 1.25  # cells; outer radius over inner radius
FINEST_LEVEL, MOST_BLOCKS = 2, 6000
SLACK = 1e-3  # cells by which blocks are larger than they are, so that rounding never costs a hit

STEEP = 1e-9  # cells a metre; a steeper ray is as good as vertical, and walked from its begin
SHORTER = 1e-9  # share of a distance, so that rounding never costs a hit

Doubles = NDArray[np.float64]


@inlined
def _pseudo_angle(x: float, y: float) -> float:
    """An angle of 0..4 that grows with the azimuth."""
    ratio = y / (abs(x) + abs(y))
    if x < 0.0:
        return 2.0 - ratio
    return 4.0 + ratio if y < 0.0 else ratio


@inlined
def _ring(radius: float) -> int:
    """The ring that holds a distance."""
    if radius < FIRST_RING:
        return 0
    return min(1 + int(math.log(radius / FIRST_RING) / math.log(GROWTH)), RINGS - 1)


@inlined
def _raise_block(
    highest: float, box: tuple[float, float, float, float], profile: NDArray[np.float64]
) -> None:
    """Enters a block, at its place from the origin, into the parts that it touches."""
    low_u, high_u, low_v, high_v = box
    near = math.hypot(max(low_u, -high_u, 0.0), max(low_v, -high_v, 0.0))
    far = math.hypot(max(-low_u, high_u), max(-low_v, high_v))
    first, last = 0, SECTORS - 1
    if near > 0.0:
        middle = _pseudo_angle(0.5 * (low_u + high_u), 0.5 * (low_v + high_v))
        least, most = 0.0, 0.0
        for corner in range(4):
            u, v = (high_u if corner & 1 else low_u), (high_v if corner & 2 else low_v)
            apart = _pseudo_angle(u, v) - middle
            apart -= 4.0 * math.floor(0.25 * apart + 0.5)
            least, most = min(least, apart), max(most, apart)
        first = math.floor((middle + least) * (SECTORS / 4.0) - SLACK)
        last = math.floor((middle + most) * (SECTORS / 4.0) + SLACK)
    begin, end = _ring(near * (1.0 - SHORTER)), _ring(far * (1.0 + SHORTER))
    for sector in range(int(first), int(last) + 1):
        for ring in range(begin, end + 1):
            part = profile[sector & (SECTORS - 1)]
            part[ring] = max(part[ring], highest)


@inlined
def _level(shape: tuple[int, int], reach: float, levels: int) -> int:
    """The finest level whose blocks within reach are few enough."""
    for level in range(FINEST_LEVEL, levels):
        size = 1 << level
        across = min(2.0 * reach, shape[0] - 1.0) / size * min(2.0 * reach, shape[1] - 1.0) / size
        if across <= MOST_BLOCKS:
            return level
    return levels - 1


@kernel()
def highest_points(
    shape: tuple[int, int],
    pyramid: NDArray[np.float32],
    levels: NDArray[np.int64],
    frame: Doubles,
    origin: Doubles,
    range_max: float,
    profile: Doubles,
) -> None:
    """Sets `profile` to the highest point of each part of the map around an origin.

    Args:
        shape: Vertices of the map, rows and columns.
        pyramid: Maxima of the blocks of each level, as cast_rays takes them.
        levels: Where a level begins in the pyramid and its blocks per row, shape (levels, 2).
        frame: World position of the map's corner and field units per metre, as cast_rays takes them.
        origin: Where the rays start in the world [m], shape (3,).
        range_max: How far rays go [m]; beyond, nothing is known.
        profile: Result, shape (SECTORS, RINGS); all inf from an origin that is not over the map.
    """
    u = (origin[0] - frame[0, 0]) * frame[1, 0]
    v = (origin[1] - frame[0, 1]) * frame[1, 1]
    rows, cols = shape[0] - 1, shape[1] - 1
    profile[:] = np.inf
    if not (0.0 <= u <= cols and 0.0 <= v <= rows) or levels.shape[0] <= 1:
        return
    profile[:] = -np.inf
    reach = range_max * max(frame[1, 0], frame[1, 1]) + 1.0
    level = _level(shape, reach, levels.shape[0])
    start, width = levels[level, 0], levels[level, 1]
    low_row, high_row = int(max(v - reach, 0.0)) >> level, int(min(v + reach, rows - 1.0)) >> level
    low_col, high_col = int(max(u - reach, 0.0)) >> level, int(min(u + reach, cols - 1.0)) >> level
    for row in range(low_row, high_row + 1):
        low_v = (row << level) - SLACK - v
        high_v = min((row + 1) << level, rows) + SLACK - v
        for col in range(low_col, high_col + 1):
            low_u = (col << level) - SLACK - u
            high_u = min((col + 1) << level, cols) + SLACK - u
            highest = float(pyramid[start + row * width + col])
            _raise_block(highest, (low_u, high_u, low_v, high_v), profile)


@kernel()
def clear_ways(
    profile: Doubles,
    frame: Doubles,
    origin: Doubles,
    directions: Doubles,
    range_max: float,
    clear: Doubles,
) -> None:
    """Sets `clear` to distances [m] before which no ray meets the surface; inf for those that never do.

    A distance above 0 also means that the origin is above the surface.

    Args:
        profile: As highest_points gives it for the same origin.
        frame: World position of the map's corner and field units per metre, as cast_rays takes them.
        origin: Where the rays start in the world [m], shape (3,).
        directions: Unit vectors in the world, shape (n, 3).
        range_max: Where rays end [m].
        clear: Result, shape (n,).
    """
    su, sv, sw = frame[1, 0], frame[1, 1], frame[1, 2]
    w = (origin[2] - frame[0, 2]) * sw
    radii = np.full(RINGS, FIRST_RING)
    for ring in range(1, RINGS - 1):
        radii[ring] = radii[ring - 1] * GROWTH
    radii[RINGS - 1] = np.inf
    for i in range(clear.shape[0]):
        du, dv, dw = directions[i, 0] * su, directions[i, 1] * sv, directions[i, 2] * sw
        pace = math.sqrt(du * du + dv * dv)
        clear[i] = 0.0
        if pace < STEEP:
            continue
        sector = int(_pseudo_angle(du, dv) * (SECTORS / 4.0)) & (SECTORS - 1)
        slope, farthest, passed = dw / pace, range_max * pace, 0.0
        for ring in range(RINGS):
            if w + slope * (radii[ring] if slope < 0.0 else passed) <= profile[sector, ring]:
                break
            passed = radii[ring]
            if passed > farthest:
                passed = np.inf
                break
        clear[i] = passed / pace * (1.0 - SHORTER)
