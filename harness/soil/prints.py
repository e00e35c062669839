"""What a wheel leaves in the ground: its print, and what that displaced, heaped beside it.

Compiled by numba. `grids` are heights of the ground without ruts and with them [m], and MuJoCo's of 0 to
1, all of one shape. `frame` is the corner x, y of that grid, the distance of its vertices, the height
of MuJoCo's 0 and of its 1 above that [m]. `ahead` is a unit vector, the wheel's heading on the map.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined
from harness.soil.rim import COMPACTION, Doubles
from harness.soil.soils import SOIL_CONTACT

Pair = tuple[float, float]
Grids = tuple[Doubles, Doubles, NDArray[np.float32]]
Frame = tuple[float, float, float, float, float]


@inlined
def level(field: Doubles, u: float, v: float) -> float:
    """Value of a grid between its vertices; bilinear, clamped to the map.

    Args:
        field: Shape (rows, columns).
        u: Column from the grid's corner [cells].
        v: Row from the grid's corner [cells].
    """
    rows, columns = field.shape
    u, v = min(max(u, 0.0), columns - 1.001), min(max(v, 0.0), rows - 1.001)
    col, row = int(u), int(v)
    du, dv = u - col, v - row
    low = field[row, col] * (1.0 - du) + field[row, col + 1] * du
    high = field[row + 1, col] * (1.0 - du) + field[row + 1, col + 1] * du
    return float(low * (1.0 - dv) + high * dv)


@inlined
def _window(low: float, high: float, begin: float, cell: float, count: int) -> range:
    """Rows or columns of a grid, which begins there, from one place to just behind another [m]."""
    first, last = int((low - begin) / cell), int((high - begin) / cell) + 1
    return range(max(first, 0), min(last, count - 1) + 1)


@inlined
def press_down(
    grids: Grids,
    frame: Frame,
    hub: Pair,
    ahead: Pair,
    size: Pair,
    plane: tuple[float, float, float, float],
) -> float:
    """Leaves the wheel's print in the ground; returns the sum of the heights that it took [m].

    Args:
        grids: As the module's docstring says.
        frame: As the module's docstring says.
        hub: Of the wheel in the world [m].
        ahead: As the module's docstring says.
        size: Radius and width of the wheel [m].
        plane: Height of the ground under the hub [m], its slopes ahead and to the left, the sinkage [m].
    """
    _, surface, field = grids
    x0, y0, cell, base, scale = frame[0], frame[1], frame[2], frame[3], 1.0 / frame[4]
    (r, b), (height, slope_x, slope_y, sinkage) = size, plane
    length = r * math.sin(math.acos(1.0 - min(sinkage, r) / r))
    reach_x = abs(ahead[0]) * length + 0.5 * abs(ahead[1]) * b
    reach_y = abs(ahead[1]) * length + 0.5 * abs(ahead[0]) * b
    rows, columns = surface.shape
    moved = 0.0
    for row in _window(hub[1] - reach_y, hub[1] + reach_y, y0, cell, rows):
        for col in _window(hub[0] - reach_x, hub[0] + reach_x, x0, cell, columns):
            dx, dy = x0 + col * cell - hub[0], y0 + row * cell - hub[1]
            x, y = dx * ahead[0] + dy * ahead[1], dy * ahead[0] - dx * ahead[1]
            if abs(x) > length or abs(y) > 0.5 * b:
                continue
            depth = (sinkage - r + math.sqrt(r * r - x * x)) * (1.0 - COMPACTION)
            bottom = height + slope_x * x + slope_y * y - depth
            if depth > 0.0 and bottom < surface[row, col]:
                moved += surface[row, col] - bottom
                surface[row, col] = bottom
                field[row, col] = (bottom - base) * scale
    return moved


@inlined
def heap(grids: Grids, frame: Frame, hub: Pair, ahead: Pair, size: Pair, moved: float) -> bool:
    """Heaps displaced ground beside a wheel; returns whether there was room.

    Args:
        grids: As the module's docstring says.
        frame: As the module's docstring says.
        hub: Of the wheel in the world [m].
        ahead: As the module's docstring says.
        size: Half the length that is heaped along, and the wheel's width [m].
        moved: Sum of the heights that are heaped [m].
    """
    virgin, surface, field = grids
    x0, y0, cell, base, scale = frame[0], frame[1], frame[2], frame[3], 1.0 / frame[4]
    near, far = 0.5 * size[1] + cell, 0.5 * size[1] + 3.0 * cell
    reach_x = abs(ahead[0]) * size[0] + abs(ahead[1]) * far
    reach_y = abs(ahead[1]) * size[0] + abs(ahead[0]) * far
    rows, columns = surface.shape
    heaped, share = 0, 0.0
    for turn in range(2):  # counts, then heaps
        for row in _window(hub[1] - reach_y, hub[1] + reach_y, y0, cell, rows):
            for col in _window(hub[0] - reach_x, hub[0] + reach_x, x0, cell, columns):
                dx, dy = x0 + col * cell - hub[0], y0 + row * cell - hub[1]
                x, y = dx * ahead[0] + dy * ahead[1], dy * ahead[0] - dx * ahead[1]
                if abs(x) > size[0] or not near <= abs(y) <= far:
                    continue
                if turn == 0:
                    heaped += 1
                else:
                    virgin[row, col] += share
                    surface[row, col] += share
                    field[row, col] = (surface[row, col] - base) * scale
        share = moved / max(heaped, 1)
    return heaped > 0


NEAR = 0.02  # [m] around what touches the ground at most a step later, were it as fast as 8 m/s


@inlined
def let_near_touch(
    near: NDArray[np.int64],
    boxes: Doubles,
    placed: tuple[Doubles, Doubles],
    affinity: NDArray[np.int32],
    solid: Doubles,
    corner: tuple[float, float, float],
) -> None:
    """Lets MuJoCo look for contacts of the ground only with what will be near it in the next step.

    Its look at the cells under an underside costs more than the rest of the step, and finds nothing.

    Args:
        near: Geoms that are no wheel and touch soil.
        boxes: Middle and half sizes of each in its own frame [m], shape (n, 6).
        placed: MuJoCo's geom_xpos and geom_xmat.
        affinity: MuJoCo's geom_conaffinity.
        solid: Heights that they meet [m].
        corner: x, y of the solid heights and their distance [m].
    """
    x0, y0, cell = corner
    rows, columns = solid.shape
    for i in range(near.size):
        geom = near[i]
        at, turn = placed[0][geom], placed[1][geom]
        low, reach = np.empty(3), np.empty(3)
        for k in range(3):
            middle, reach[k] = at[k], NEAR
            for j in range(3):
                middle += turn[3 * k + j] * boxes[i, j]
                reach[k] += abs(turn[3 * k + j]) * boxes[i, 3 + j]
            low[k] = middle - reach[k]
        touches = False
        for row in _window(low[1], low[1] + 2.0 * reach[1], y0, cell, rows):
            for col in _window(low[0], low[0] + 2.0 * reach[0], x0, cell, columns):
                touches |= solid[row, col] > low[2]
            if touches:
                break
        affinity[geom] = affinity[geom] | SOIL_CONTACT if touches else affinity[geom] & ~SOIL_CONTACT
