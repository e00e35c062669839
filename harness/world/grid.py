"""Grids of cells: how far each is from what is occupied, and how far to travel from it to a goal.

Distances are roots of whole numbers, sums are made in a fixed order: every machine gets the same bits.
"""

import heapq
import math

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt

from harness.base.compiled import inlined, kernel

FAR = 1e12  # cells squared: there is nothing occupied
# Moves to the neighbours, and to those a knight's move away: lengths are at most 2.8 % too long.
STEPS = np.array(
    [(r, c) for r in range(-2, 3) for c in range(-2, 3) if abs(r) + abs(c) in (1, 3) or abs(r * c) == 1],
    np.int64,
)

Cells = NDArray[np.bool_]
Lengths = NDArray[np.float64]


def distances(occupied: Cells) -> Lengths:
    """Returns how far each cell's middle is from that of the nearest occupied one, in cells."""
    if not occupied.any():
        return np.full(occupied.shape, math.sqrt(FAR))
    return np.asarray(distance_transform_edt(~occupied), np.float64)


@inlined
def _passes(cost: Lengths, row: int, column: int, down: int, right: int) -> bool:
    """Whether the cells that a knight's move crosses can be driven; others cross none."""
    if abs(down) + abs(right) < 3:
        return True
    if abs(down) == 2:
        half = down // 2
        return bool(cost[row + half, column] < FAR and cost[row + half, column + right] < FAR)
    half = right // 2
    return bool(cost[row, column + half] < FAR and cost[row + down, column + half] < FAR)


@kernel("f8[:,:](f8[:,:], i8[:,:], f8[:], i8[:,:])")
def travel(cost: Lengths, goals: NDArray[np.int64], begin: Lengths, steps: NDArray[np.int64]) -> Lengths:
    """Returns the least sum of costs on a way from each cell to a goal; inf where there is none.

    Args:
        cost: Of a cell's length of way through each, 1 for plain ground; inf where none leads through.
        goals: Row and column of each, shape (n, 2).
        begin: What is added at each goal, shape (n,).
        steps: STEPS.
    """
    rows, columns = cost.shape
    to_go = np.full((rows, columns), np.inf)
    queue = [(0.0, 0, 0)]
    queue.clear()
    for number in range(len(goals)):
        row, column = goals[number]
        if begin[number] < to_go[row, column]:
            to_go[row, column] = begin[number]
            heapq.heappush(queue, (begin[number], row, column))
    while len(queue) > 0:
        so_far, row, column = heapq.heappop(queue)
        if so_far > to_go[row, column]:
            continue
        for step in range(len(steps)):
            down, right = steps[step]
            r, c = row + down, column + right
            if r < 0 or c < 0 or r >= rows or c >= columns or not cost[r, c] < FAR:
                continue
            if not _passes(cost, row, column, down, right):
                continue
            length = math.sqrt(down * down + right * right)
            total = so_far + 0.5 * length * (cost[row, column] + cost[r, c])
            if total < to_go[r, c]:
                to_go[r, c] = total
                heapq.heappush(queue, (total, r, c))
    return to_go
