"""Which heading is the freest near a goal, by the returns of a scan, compiled by numba."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel

RANGE_WEIGHT = 1.5  # [rad/m] that a heading may be farther from the goal's for each metre more ahead


@kernel("Tuple((int64, float64))(float32[::1], float64[:,::1], float64[::1], float64, float64)")
def freest(
    ranges: NDArray[np.float32],
    corridors: NDArray[np.float64],
    headings: NDArray[np.float64],
    goal: float,
    farthest: float,
) -> tuple[int, float]:
    """Weighs how far each heading is from the goal's against RANGE_WEIGHT times the range free along it.

    Args:
        ranges: Of a scan [m], shape (beams,); -inf: nearer than visible, NaN: none.
        corridors: Within which a return blocks a heading [m], shape (beams, headings).
        headings: Candidates [rad], shape (headings,); the one in the middle is straight ahead.
        goal: Where it is [rad].
        farthest: The longest corridor [m]: beyond it nothing blocks.

    Returns:
        The index of the best heading, the first of those that are alike, and the range that is free
        straight ahead [m], inf if nothing blocks it.
    """
    free = np.full(headings.size, np.inf)
    for beam in range(ranges.size):
        distance = max(np.float64(ranges[beam]), 0.0)
        if distance < farthest:
            for heading in range(free.size):
                if distance < corridors[beam, heading] and distance < free[heading]:
                    free[heading] = distance
    best, least = 0, np.inf
    for heading in range(free.size):
        off = headings[heading] - goal + math.pi
        aside = abs(off % math.tau - math.pi)
        cost = aside - RANGE_WEIGHT * min(free[heading], farthest)
        if cost < least:
            best, least = heading, cost
    return best, free[free.size // 2]
