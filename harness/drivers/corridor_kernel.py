"""Which headings the returns of a scan block, compiled by numba."""

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel


@kernel("void(float32[::1], float64[:,::1], float64[::1], float64)")
def block(
    ranges: NDArray[np.float32],
    corridors: NDArray[np.float64],
    free: NDArray[np.float64],
    farthest: float,
) -> None:
    """Lowers the free range of each heading to the nearest return that blocks it.

    Args:
        ranges: Of a scan [m], shape (beams,); -inf: nearer than visible, NaN: none.
        corridors: Within which a return blocks a heading [m], shape (beams, headings).
        free: The free ranges [m], shape (headings,).
        farthest: The longest corridor [m]: beyond it nothing blocks.
    """
    for beam in range(ranges.size):
        distance = max(np.float64(ranges[beam]), 0.0)
        if distance < farthest:
            for heading in range(free.size):
                if distance < corridors[beam, heading] and distance < free[heading]:
                    free[heading] = distance
