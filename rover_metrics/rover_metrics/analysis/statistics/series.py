"""What a metric says row by row: levels as they are, counters as rates, flags as percent; outliers."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats, Log
from rover_metrics.analysis.metric import DISTANCE, ROUGH, Kind, Metric

SECONDS_PER_MINUTE = 60.0
DEFAULT_MULTIPLIER = 1.5  # interquartile ranges, Tukey's
SHORTEST_DISTANCE = 1.0  # m; over less, a rate per metre says how the rover stood, not how it drove


@dataclass(frozen=True, eq=False)
class Series:
    """One metric over the rows of a log, each value with what it counts in a mean.

    For rates that is the seconds it is the rate of, so that the mean is the total over the time; else 1.
    """

    values: Floats  # in the metric's unit; NaN in rows that say nothing of it
    weights: Floats

    def finite(self, rows: slice = slice(None)) -> tuple[Floats, Floats]:
        """Returns the values and weights of the rows that have a value."""
        values, weights = self.values[rows], self.weights[rows]
        known = np.isfinite(values)
        return values[known], weights[known]

    def mean(self, rows: slice = slice(None)) -> float:
        """Returns the weighted mean, NaN if there is no value."""
        values, weights = self.finite(rows)
        return float(np.average(values, weights=weights)) if values.size else np.nan

    def without(self, rows: NDArray[np.bool_]) -> "Series":
        """Returns this series with some rows silenced."""
        return Series(np.where(rows, np.nan, self.values), self.weights)

    def outliers(self, kind: Kind, multiplier: float) -> NDArray[np.bool_]:
        """Marks rows further outside the quartiles than a multiple of their range (Tukey's fences).

        No row is one in a flag, nor where the quartiles coincide: of a rover that rarely collides,
        every collision would be one.
        """
        values, _ = self.finite()
        low, high = np.quantile(values, [0.25, 0.75]) if values.size else (0.0, 0.0)
        if kind is Kind.FLAG or low == high:
            return np.zeros(len(self.values), dtype=np.bool_)
        reach = multiplier * (high - low)
        return np.asarray((self.values < low - reach) | (self.values > high + reach))


def metric_series(log: Log, metric: Metric) -> Series:
    """Returns a metric of a log that has its columns.

    Rates per minute for a counter, 0 or 100 for a flag, else the column itself; for a metric of
    rough terrain only the rows with Is Rough Terrain = 1, unless an extended column has the value.
    """
    ones = np.broadcast_to(1.0, len(log))
    if metric.extended_column in log.columns:
        return Series(log.columns[metric.extended_column].astype(np.float64), ones)
    column = log.columns[metric.column].astype(np.float64)
    if metric.kind is Kind.COUNTER:  # gains per minute; the first row of an episode has none
        gains = _gains(log, column)
        times = _gains(log, np.where(np.isfinite(column), log.stamps, np.nan))
        return Series(gains / times * SECONDS_PER_MINUTE, times)
    if metric.kind is Kind.FLAG:
        column *= 100.0
    if metric.rough_only:
        column = np.where(log.columns[ROUGH] == 1.0, column, np.nan)
    return Series(column, ones)


def rate_per_metre(log: Log, metric: Metric) -> float | None:
    """Returns what a counter gained per metre driven.

    None for other columns, for the distance itself, and for less than SHORTEST_DISTANCE.
    """
    if metric.kind is not Kind.COUNTER or metric.column == DISTANCE or DISTANCE not in log.columns:
        return None
    gained, driven = (_gains(log, log.columns[name]) for name in (metric.column, DISTANCE))
    both = np.isfinite(gained) & np.isfinite(driven)
    metres = float(driven[both].sum())
    return float(gained[both].sum()) / metres if metres >= SHORTEST_DISTANCE else None


def _gains(log: Log, column: NDArray[np.floating]) -> Floats:
    """Returns what a column gained since the last known row of the same episode; NaN if none."""
    rows = np.flatnonzero(np.isfinite(column))
    episode = np.searchsorted(log.starts, rows, side="right")
    inside = episode[1:] == episode[:-1]
    gains = np.full(len(log), np.nan)
    gains[rows[1:][inside]] = np.diff(column[rows].astype(np.float64))[inside]
    return gains
