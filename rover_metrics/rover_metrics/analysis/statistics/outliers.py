"""Outliers by Tukey's fences: values further outside the quartiles than a multiple of their range."""

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.series import Series

DEFAULT_MULTIPLIER = 1.5


def outliers(series: Series, kind: Kind, multiplier: float) -> NDArray[np.bool_]:
    """Mark the outliers of a series.

    Args:
        series: One log's.
        kind: A flag has no outliers.
        multiplier: How many interquartile ranges beyond the quartiles a value may lie.

    Returns:
        One verdict a row. None is an outlier where the quartiles coincide: of a rover that rarely
        collides, every collision would be one.
    """
    values, _ = series.finite()
    nothing = np.zeros(len(series.values), dtype=np.bool_)
    if kind is Kind.FLAG or not values.size:
        return nothing
    low, high = np.quantile(values, [0.25, 0.75])
    reach = multiplier * (high - low)
    if reach == 0:
        return nothing
    return np.asarray((series.values < low - reach) | (series.values > high + reach))
