"""The logs of an analysis, how they are named and grouped, and what is computed of them."""

import itertools
import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats, Log, TimeAxis
from rover_metrics.analysis.metric import METRICS, Metric
from rover_metrics.analysis.pairing import Pairs
from rover_metrics.analysis.statistics.series import DEFAULT_MULTIPLIER, Series, metric_series
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.errors import printable

Unit = Literal["log", "episode"]
PlotName = Literal["time_series", "correlation", "aggregate", "comparison"]
PLOTS: tuple[PlotName, ...] = get_args(PlotName)
_LONGEST_LABEL = 40  # characters
_LOG_PREFIX = "metrics_log_"
_TIME_STAMP = re.compile(_LOG_PREFIX + r"\d{8}_\d{6}\w*")  # as metrics_node calls its files


def labels(logs: Sequence[Log]) -> list[str]:
    """Names different logs: by what a person called the file, else by what was driven, else by its time.

    Names that are alike take what distinguishes them: the time, then as many folders as it takes.

    Returns one name per log, without control characters, at most 40 characters and a number.
    """
    counts, parts = Counter(map(_name, logs)), []
    for log in logs:
        name, stem = _name(log), log.path.stem
        if counts[name] > 1 and name != stem:
            name = f"{name}, {stem.removeprefix(_LOG_PREFIX)}"
        parts.append((*log.path.absolute().parts[1:-1], name))
    names = [part[-1] for part in parts]
    for depth in range(2, max(map(len, parts), default=0) + 1):
        counts = Counter(names)
        names = [
            "/".join(part[-depth:]) if counts[name] > 1 else name
            for part, name in zip(parts, names, strict=True)
        ]
    half = _LONGEST_LABEL // 2
    names = [
        name if len(name) <= _LONGEST_LABEL else f"{name[: half - 2]}...{name[-half + 1 :]}"
        for name in map(printable, names)
    ]
    counts = Counter(names)
    numbers: dict[str, Iterator[int]] = defaultdict(lambda: itertools.count(1))
    return [f"{name} ({next(numbers[name])})" if counts[name] > 1 else name for name in names]


def _name(log: Log) -> str:
    """Returns the file's stem, or robot, terrain, difficulty and seed where the stem is but a time."""
    arguments = log.arguments
    if not _TIME_STAMP.fullmatch(log.path.stem) or not {"robot", "terrain", "seed"} <= set(arguments):
        return log.path.stem
    terrain = Path(str(arguments["terrain"]))  # a name, or a heightmap, which has no difficulty
    difficulty = arguments.get("difficulty")
    if terrain.suffix or not isinstance(difficulty, int | float) or not 0 <= difficulty <= 1:
        return f"{arguments['robot']} {terrain.stem} seed {arguments['seed']}"
    return f"{arguments['robot']} {terrain.stem} {difficulty:g} seed {arguments['seed']}"


@dataclass(frozen=True)
class Options:
    """What to look at and how."""

    metrics: tuple[Metric, ...] = tuple(METRICS.values())  # in the order of the report
    confidence: float = 0.95  # level of every interval, between 0 and 1
    iqr_multiplier: float = DEFAULT_MULTIPLIER  # interquartile ranges from the quartiles to an outlier
    remove_outliers: bool = False  # from everything; they are counted anyway
    unit: Unit = "log"  # one observation of a comparison: the mean of a log or of an episode
    ranked: bool = False  # whether metrics are compared in the order of their effects
    plots: tuple[PlotName, ...] = ()  # pairs of metrics are correlated only if that is drawn
    axis: TimeAxis = field(default_factory=TimeAxis)  # of the plots that have one


@dataclass(frozen=True, eq=False)
class Study:
    """Logs, in one group or in two that are compared, and how to look at them.

    Pairs are places of logs that belong together, in the first group and in the second.
    """

    logs: tuple[Log, ...]
    groups: tuple[str, ...]
    options: Options
    pairs: Pairs = ()

    def with_metric(self, metric: Metric) -> list[Log]:
        """Returns the logs that have the columns of a metric."""
        return [log for log in self.logs if log.has(metric)]

    def bounds(self, metric: Metric) -> dict[str, list[float]]:
        """Returns the values of the thresholds that bound a metric, by name: those that its logs had."""
        had = [log.thresholds or DEFAULT_THRESHOLDS for log in self.with_metric(metric)]
        return {name: sorted({getattr(each, name) for each in had}) for name in metric.thresholds}

    def outliers(self, log: Log, metric: Metric) -> NDArray[np.bool_]:
        """Marks the rows of a log whose value is an outlier, whether they are removed or not."""
        return metric_series(log, metric).outliers(metric.kind, self.options.iqr_multiplier)

    def series(self, log: Log, metric: Metric) -> Series:
        """Returns a metric of a log, without outliers if they are to be removed."""
        series = metric_series(log, metric)
        return series.without(self.outliers(log, metric)) if self.options.remove_outliers else series

    def episodes(self, log: Log, metric: Metric) -> Iterator[tuple[Floats, Floats]]:
        """Yields positions on the time axis and values of each episode of a log."""
        values = self.series(log, metric).values
        for rows in log.episodes:
            yield self.options.axis.place(log.stamps[rows], values[rows])

    def observations(self, metric: Metric, group: str) -> Floats:
        """Returns one mean per log (or episode) of a group, where there is one."""
        values = self._means(metric, group)
        return values[np.isfinite(values)]

    def compared(self, metric: Metric) -> tuple[Floats, Floats]:
        """Returns the observations of the two groups; of pairs in their order, those that are whole."""
        first, second = self.groups
        if not self.pairs:
            return self.observations(metric, first), self.observations(metric, second)
        places = np.array(self.pairs).T
        both = [
            self._means(metric, group)[of_group]
            for group, of_group in zip(self.groups, places, strict=True)
        ]
        whole = np.isfinite(both).all(axis=0)
        return both[0][whole], both[1][whole]

    def _means(self, metric: Metric, group: str) -> Floats:
        """Returns one mean per log (or episode) of a group, NaN where there is none."""
        means: list[float] = []
        for log in self.logs:
            if log.group == group:
                units = log.episodes if self.options.unit == "episode" else [slice(None)]
                series = self.series(log, metric) if log.has(metric) else None
                means += [np.nan if series is None else series.mean(rows) for rows in units]
        return np.array(means, dtype=np.float64)
