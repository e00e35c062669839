"""Curves for the eye: smoothed, thinned to what paper can show, with limits that outliers cannot set."""

from typing import Literal

import numpy as np
import pandas as pd

from rover_metrics.analysis.logs.log import Floats

MOST_POINTS = 4000  # two a pixel at 200 dpi
_FEWEST_SMOOTHED = 9  # rows
_MOST_SMOOTHED = 20_000

Smoothing = Literal["mean", "median"]


def smoothed(positions: Floats, values: Floats, share: float, how: Smoothing) -> tuple[Floats, Floats]:
    """Returns the mean or median over the nearest rows; NaN where none of them has a value.

    Of a long episode, positions and values are those of the means of short runs of rows.

    Args:
        positions: Those of the rows of an episode.
        values: As many.
        share: How much of the episode to take; at least nine rows.
        how: The mean suits rates and shares; the median is not lifted by a single jolt.
    """
    positions, values = _condensed(positions), _condensed(values)
    window = max(_FEWEST_SMOOTHED, round(values.size * share))
    rolling = pd.Series(values).rolling(window, center=True, min_periods=1)
    curve = rolling.mean() if how == "mean" else rolling.median()
    return positions, curve.to_numpy(dtype=np.float64)


def _condensed(values: Floats) -> Floats:
    """Averages runs of equal length so that few enough values remain; a run without any gives NaN."""
    if values.size <= _MOST_SMOOTHED:
        return values
    run = -(-values.size // _MOST_SMOOTHED)
    return np.asarray(pd.Series(values).groupby(np.arange(values.size) // run).mean(), dtype=np.float64)


def thinned(positions: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Keeps lowest and highest value of equal runs, so that no peak is lost and files stay small."""
    known = np.isfinite(values)
    positions, values = positions[known], values[known]
    if values.size <= MOST_POINTS:
        return positions, values
    run = -(-values.size // (MOST_POINTS // 2))
    begins = np.arange(0, values.size, run)
    picked = [
        begin + extreme(values[begin : begin + run])
        for begin in begins
        for extreme in (np.argmin, np.argmax)
    ]
    rows = np.unique(picked)
    return positions[rows], values[rows]


def upper_limit(samples: list[Floats], at_least: float) -> tuple[float, int, float]:
    """Chooses where a y axis ends, so that a few peaks do not flatten all else.

    Returns the end of the axis, at_least or more, how many values lie beyond, and the highest.
    """
    values = np.concatenate([sample[np.isfinite(sample)] for sample in samples] or [np.zeros(1)])
    if not values.size:
        return max(at_least, 1.0), 0, 0.0
    highest = float(values.max())
    usual = float(np.quantile(values, 0.995))
    end = max(1.1 * (usual if highest > 1.5 * usual and usual > 0 else highest), at_least)
    return (end or 1.0), int((values > end).sum()), highest
