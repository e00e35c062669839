"""Rasters without gaps and on other grids."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


def filled(values: Values) -> Values:
    """Returns the raster with missing values (NaN) replaced by a smooth surface through the rest.

    Means over blocks of 2 x 2, recursively, until no gap is left; then back down (a pull-push pyramid).
    """
    missing = np.isnan(values)
    if not missing.any():
        return values
    rows, columns = values.shape
    even = np.pad(values, ((0, rows % 2), (0, columns % 2)), constant_values=np.nan)
    blocks = even.reshape(even.shape[0] // 2, 2, even.shape[1] // 2, 2)
    known = (~np.isnan(blocks)).sum(axis=(1, 3))
    sums = np.nansum(blocks, axis=(1, 3))
    coarse = filled(np.where(known > 0, sums / np.maximum(known, 1), np.nan))
    # A block's middle lies between its pixels.
    return np.where(missing, _bilinear(coarse, (0.5, 0.5), (-0.25, -0.25), values.shape), values)


def resampled(values: Values, step: tuple[float, float], count: int) -> Values:
    """Returns values on a square grid in the middle of another one.

    Where the new grid is coarser, means are taken first, so that no roughness turns into hills.

    Args:
        values: Shape (rows, columns).
        step: Distance of the new points in rows and in columns.
        count: New points along each side.
    """
    from scipy.ndimage import uniform_filter  # noqa: PLC0415 - see _bilinear

    widths = [2 * (round(stride) // 2) + 1 for stride in step]  # odd
    first = [
        0.5 * (size - 1) - 0.5 * stride * (count - 1)
        for size, stride in zip(values.shape, step, strict=True)
    ]
    return _bilinear(uniform_filter(values, widths, mode="nearest"), step, first, (count, count))


def _bilinear(
    values: Values, step: Sequence[float], first: Sequence[float], shape: tuple[int, ...]
) -> Values:
    """Values on another grid; positions beyond the edge take the edge's value."""
    from scipy.ndimage import affine_transform  # noqa: PLC0415 - 0.1 s that named terrains save

    return np.asarray(affine_transform(values, step, first, shape, order=1, mode="nearest"))
