"""The room in which drivers may wander between the pits of a ground."""

import numpy as np
from numpy.typing import NDArray

from harness.world.solids.surface import Bounds, Surface

BLOCK = 1.0  # [m]: how finely the room is measured


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
    """Returns the largest rectangle that is true everywhere: first row, end row, first and end column.

    Args:
        free: Shape (rows, columns).
    """
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
