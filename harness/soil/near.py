"""Which geoms that are no wheel MuJoCo looks for contacts of, on ground that gives way."""

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined
from harness.soil.prints import window
from harness.soil.rim import Doubles
from harness.soil.soils import SOIL_CONTACT

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
        for row in window(low[1], low[1] + 2.0 * reach[1], y0, cell, rows):
            for col in window(low[0], low[0] + 2.0 * reach[0], x0, cell, columns):
                touches |= solid[row, col] > low[2]
            if touches:
                break
        affinity[geom] = affinity[geom] | SOIL_CONTACT if touches else affinity[geom] & ~SOIL_CONTACT
