"""The logs of an analysis, how they are grouped, and what is to be found out about them."""

from dataclasses import dataclass

import numpy as np

from rover_metrics.analysis.logs.log import Floats, Log
from rover_metrics.analysis.metric import METRICS, Metric
from rover_metrics.analysis.result import Unit
from rover_metrics.analysis.statistics.outliers import DEFAULT_MULTIPLIER, outliers
from rover_metrics.analysis.statistics.series import Series, metric_series
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS


@dataclass(frozen=True)
class Options:
    """What to look at and how.

    Attributes:
        metrics: In the order of the report.
        confidence: Level of every interval, between 0 and 1.
        iqr_multiplier: Interquartile ranges beyond the quartiles where an outlier begins.
        remove_outliers: Whether outliers are left out of everything; they are counted anyway.
        unit: One observation of a comparison: the mean of a log or of an episode.
        correlate: Whether to correlate every pair of metrics.
    """

    metrics: tuple[Metric, ...] = tuple(METRICS.values())
    confidence: float = 0.95
    iqr_multiplier: float = DEFAULT_MULTIPLIER
    remove_outliers: bool = False
    unit: Unit = "log"
    correlate: bool = False


@dataclass(frozen=True, eq=False)
class Member:
    """A log of a study: its short name, which is unique, and its group."""

    log: Log
    label: str
    group: str


@dataclass(frozen=True, eq=False)
class Study:
    """Logs, in one group or in two that are compared, and how to look at them."""

    members: tuple[Member, ...]
    groups: tuple[str, ...]
    options: Options

    def with_metric(self, metric: Metric) -> list[Member]:
        """The logs that have the columns of a metric."""
        return [member for member in self.members if member.log.has(metric)]

    def bounds(self, metric: Metric) -> dict[str, list[float]]:
        """Give the values of the thresholds that bound a metric, by name: those that its logs had."""
        had = [member.log.thresholds or DEFAULT_THRESHOLDS for member in self.with_metric(metric)]
        return {name: sorted({getattr(each, name) for each in had}) for name in metric.thresholds}

    def series(self, log: Log, metric: Metric) -> Series:
        """Derive a metric of a log, without outliers if they are to be removed."""
        series = metric_series(log, metric)
        if not self.options.remove_outliers:
            return series
        return series.without(outliers(series, metric.kind, self.options.iqr_multiplier))

    def observations(self, metric: Metric, group: str) -> Floats:
        """Give one mean per log (or episode) of a group, where there is one."""
        means = []
        for member in self.with_metric(metric):
            if member.group == group:
                series = self.series(member.log, metric)
                by_episode = self.options.unit == "episode"
                units = member.log.episodes if by_episode else [slice(None)]
                means += [series.mean(rows) for rows in units]
        values = np.array(means, dtype=np.float64)
        return values[np.isfinite(values)]
