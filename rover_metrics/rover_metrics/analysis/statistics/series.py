"""What a metric says row by row: levels as they are, counters as rates, flags as percent."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats, Log
from rover_metrics.analysis.metric import DISTANCE, ROUGH, Kind, Metric

SECONDS_PER_MINUTE = 60.0
SHORTEST_DISTANCE = 1.0  # m; over less, a rate per metre says how the rover stood, not how it drove


@dataclass(frozen=True, eq=False)
class Series:
    """One metric over the rows of a log.

    Attributes:
        values: In the metric's unit; NaN in rows that say nothing of it.
        weights: How much a value counts in a mean: for rates the seconds it is the rate of, so that
            the mean is the total over the time; else 1.
    """

    values: Floats
    weights: Floats

    def finite(self, rows: slice = slice(None)) -> tuple[Floats, Floats]:
        """Give the values and weights of the rows that have a value."""
        values, weights = self.values[rows], self.weights[rows]
        known = np.isfinite(values)
        return values[known], weights[known]

    def mean(self, rows: slice = slice(None)) -> float:
        """Give the weighted mean, NaN if there is no value."""
        values, weights = self.finite(rows)
        return float(np.average(values, weights=weights)) if values.size else np.nan

    def without(self, rows: NDArray[np.bool_]) -> "Series":
        """Give this series with some rows silenced."""
        return Series(np.where(rows, np.nan, self.values), self.weights)


def metric_series(log: Log, metric: Metric) -> Series:
    """Derive a metric from the columns of a log.

    Args:
        log: Must have the metric's columns.
        metric: What to derive.

    Returns:
        Rates per minute for a counter, 0 or 100 for a flag, else the column itself; for a metric of
        rough terrain only the rows with Is Rough Terrain = 1, unless an extended column tells more.
    """
    if metric.extended_column in log.columns:
        return Series(log.columns[metric.extended_column].astype(np.float64), _ones(log))
    column = log.columns[metric.column].astype(np.float64)
    if metric.kind is Kind.COUNTER:
        return _rates(log, column)
    if metric.kind is Kind.FLAG:
        column *= 100.0
    if metric.rough_only:
        column = np.where(log.columns[ROUGH] == 1.0, column, np.nan)
    return Series(column, _ones(log))


def _ones(log: Log) -> Floats:
    return np.broadcast_to(1.0, len(log))


def rate_per_metre(log: Log, metric: Metric) -> float | None:
    """Give what a counter gained per metre driven.

    Returns:
        The ratio of the totals; None where it makes no sense or the rover drove less than 1 m.
    """
    if not metric.per_metre or DISTANCE not in log.columns:
        return None
    gained, driven = (_gains(log, log.columns[name]) for name in (metric.column, DISTANCE))
    both = np.isfinite(gained) & np.isfinite(driven)
    metres = float(driven[both].sum())
    return float(gained[both].sum()) / metres if metres >= SHORTEST_DISTANCE else None


def _rates(log: Log, counter: Floats) -> Series:
    """Give gains per minute; the first row of an episode has none."""
    gains, times = _gains(log, counter), _gains(log, log.stamps, known=np.isfinite(counter))
    return Series(gains / times * SECONDS_PER_MINUTE, times)


def _gains(
    log: Log,
    column: NDArray[np.floating],
    known: NDArray[np.bool_] | None = None,
) -> Floats:
    """Give what a column gained since the last known row of the same episode; NaN if none."""
    rows = np.flatnonzero(np.isfinite(column) if known is None else known)
    episode = np.searchsorted(log.starts, rows, side="right")
    inside = episode[1:] == episode[:-1]
    gains = np.full(len(log), np.nan)
    gains[rows[1:][inside]] = np.diff(column[rows].astype(np.float64))[inside]
    return gains
