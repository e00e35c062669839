"""Rasters without gaps and on other grids."""

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]


def filled(values: Values) -> Values:
    """Missing values (NaN) replaced by a smooth surface through their surroundings.

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
    at_rows, at_columns = (np.asarray((np.arange(n) - 0.5) / 2.0) for n in (rows, columns))
    return np.where(missing, _interpolated(coarse, at_rows, at_columns), values)


def resampled(values: Values, step: tuple[float, float], count: int) -> Values:
    """Values on a square grid in the middle of another one.

    Where the new grid is coarser, means are taken first, so that no roughness turns into hills.

    Args:
        values: Shape (rows, columns).
        step: Distance of the new points in rows and in columns.
        count: New points along each side.
    """
    for axis, stride in enumerate(step):
        values = _moving_mean(values, round(stride), axis)
    rows, columns = (
        0.5 * (size - 1) + stride * (np.arange(count) - 0.5 * (count - 1))
        for size, stride in zip(values.shape, step, strict=True)
    )
    return _interpolated(values, rows, columns)


def _moving_mean(values: Values, width: int, axis: int) -> Values:
    """Means over an odd number of neighbours; towards the edges over what there is."""
    reach = width // 2
    if reach == 0:
        return values
    padding = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
    padded = np.pad(values, padding, mode="edge")
    sums = np.insert(np.cumsum(padded, axis=axis), 0, 0.0, axis=axis)
    upper = np.take(sums, np.arange(2 * reach + 1, sums.shape[axis]), axis=axis)
    lower = np.take(sums, np.arange(sums.shape[axis] - 2 * reach - 1), axis=axis)
    return np.asarray((upper - lower) / (2 * reach + 1))


def _interpolated(values: Values, rows: Values, columns: Values) -> Values:
    """Bilinear; positions beyond the edge take the edge's value."""
    low_row, part_row = _cells(rows, values.shape[0])
    low_column, part_column = _cells(columns, values.shape[1])
    next_row = np.minimum(low_row + 1, values.shape[0] - 1)
    next_column = np.minimum(low_column + 1, values.shape[1] - 1)
    along = values[low_row] + part_row[:, None] * (values[next_row] - values[low_row])
    return np.asarray(
        along[:, low_column] + part_column * (along[:, next_column] - along[:, low_column])
    )


def _cells(positions: Values, size: int) -> tuple[NDArray[np.intp], Values]:
    inside = np.clip(positions, 0.0, size - 1.0)
    low = np.floor(inside).astype(np.intp)
    return low, inside - low
