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
    """Take mean or median over the nearest rows; NaN where none of them has a value.

    Args:
        positions: Those of the rows of an episode.
        values: As many.
        share: How much of the episode to take; at least nine rows.
        how: The mean suits rates and shares; the median is not lifted by a single jolt.

    Returns:
        Positions and smoothed values; of a long episode, of the means of short runs of rows.
    """
    positions, values = _condensed(positions), _condensed(values)
    window = max(_FEWEST_SMOOTHED, round(values.size * share))
    rolling = pd.Series(values).rolling(window, center=True, min_periods=1)
    curve = rolling.mean() if how == "mean" else rolling.median()
    return positions, curve.to_numpy(dtype=np.float64)


def _condensed(values: Floats) -> Floats:
    """Average runs of equal length so that few enough values remain; a run without any gives NaN."""
    run = -(-values.size // _MOST_SMOOTHED)
    if run == 1:
        return values
    begins = np.arange(0, values.size, run)
    known = np.isfinite(values)
    counts = np.add.reduceat(known.astype(np.float64), begins)
    sums = np.add.reduceat(np.where(known, values, 0.0), begins)
    return np.asarray(np.divide(sums, counts, out=np.full(begins.size, np.nan), where=counts > 0))


def thinned(positions: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Keep lowest and highest value of equal runs, so that no peak is lost and files stay small."""
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
    """Choose where a y axis ends, so that a few peaks do not flatten all else.

    Args:
        samples: Values drawn.
        at_least: What must be in view.

    Returns:
        End of the axis, how many values lie beyond, and the highest.
    """
    values = np.concatenate([sample[np.isfinite(sample)] for sample in samples] or [np.zeros(1)])
    if not values.size:
        return max(at_least, 1.0), 0, 0.0
    highest = float(values.max())
    usual = float(np.quantile(values, 0.995))
    end = max(1.1 * (usual if highest > 1.5 * usual and usual > 0 else highest), at_least)
    return (end or 1.0), int((values > end).sum()), highest
