"""From a study to its result: every number there is to report, as values that turn into JSON."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import combinations

import numpy as np

from rover_metrics.analysis.logs.header import Skipped
from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.metric import METRICS, Metric
from rover_metrics.analysis.statistics.comparison import Comparison, compare, describe_power, with_holm
from rover_metrics.analysis.statistics.correlation import Correlation, combine, correlate
from rover_metrics.analysis.statistics.series import rate_per_metre
from rover_metrics.analysis.statistics.summary import Summary, summarise, summarise_independent
from rover_metrics.analysis.study import Study, Unit
from rover_metrics.errors import printable
from rover_metrics.extended.traffic_columns import TrafficColumns
from rover_metrics.log.files import json_safe

HEALTH = frozenset(printable(column.header) for column in TrafficColumns.COLUMNS)
_MOST_CORRELATED = 200_000  # rows; of longer logs every k-th is taken, as neighbours say little new


@dataclass(frozen=True)
class LogResult:
    """What there is to say of one log."""

    label: str  # short, unique among the logs
    path: str
    group: str
    rows: int  # usable
    duration: float  # time logged [s]
    episodes: int
    findings: tuple[str, ...]
    metrics: Mapping[str, Summary]  # by code; a metric the log has no column for is missing
    per_metre: Mapping[str, float]  # rates per metre driven, by code, where they make sense
    outliers: Mapping[str, int]  # values beyond the fences, by code
    correlations: tuple[Correlation, ...]


@dataclass(frozen=True)
class Result:
    """The outcome of an analysis."""

    confidence: float  # level of every interval
    outliers_removed: bool  # whether values beyond the fences were left out
    iqr_multiplier: float  # where the fences stand
    unit: Unit  # what was one observation in the comparison
    groups: tuple[str, ...]  # one, or two that are compared
    logs: tuple[LogResult, ...]
    across: Mapping[str, Mapping[str, Summary]]  # by group and code: each log's mean an observation
    correlations: tuple[Correlation, ...]  # combined over the logs
    comparisons: tuple[Comparison, ...] = ()  # second group against the first, one per metric
    titles: Mapping[str, str] = field(  # what each metric reports, with its unit, by code
        default_factory=lambda: {metric.code: metric.label for metric in METRICS.values()}
    )
    notes: tuple[str, ...] = ()  # what to know before the comparisons are believed
    skipped: tuple[Skipped, ...] = ()
    files: tuple[str, ...] = ()

    def to_json(self) -> str:
        """Returns everything as strict JSON; a number that does not exist is null."""
        return json.dumps(json_safe(asdict(self)), indent=2, ensure_ascii=False, allow_nan=False)


def analyse(study: Study) -> Result:
    """Returns everything there is to say in numbers."""
    options = study.options
    comparisons = _comparisons(study)
    logs = tuple(_log_result(study, log) for log in study.logs)
    return Result(
        confidence=options.confidence,
        outliers_removed=options.remove_outliers,
        iqr_multiplier=options.iqr_multiplier,
        unit=options.unit,
        groups=study.groups,
        logs=logs,
        across={group: _across(study, logs, group) for group in study.groups},
        correlations=_combined([log.correlations for log in logs]),
        comparisons=comparisons,
        titles={metric.code: metric.label for metric in options.metrics},
        notes=tuple(describe_power(comparisons, options.unit, 1 - options.confidence)),
    )


def _log_result(study: Study, log: Log) -> LogResult:
    options = study.options
    metrics = [metric for metric in options.metrics if log.has(metric)]
    ratios = {metric.code: rate_per_metre(log, metric) for metric in metrics}
    return LogResult(
        label=log.label,
        path=str(log.path),
        group=log.group,
        rows=len(log),
        duration=log.duration,
        episodes=len(log.starts),
        findings=log.findings,
        metrics={
            metric.code: summarise(*study.series(log, metric).finite(), metric.kind, options.confidence)
            for metric in metrics
        },
        per_metre={code: ratio for code, ratio in ratios.items() if ratio is not None},
        outliers={metric.code: int(study.outliers(log, metric).sum()) for metric in metrics},
        correlations=_correlations(study, log, metrics) if "correlation" in options.plots else (),
    )


def _correlations(study: Study, log: Log, metrics: Sequence[Metric]) -> tuple[Correlation, ...]:
    """Correlates each pair of metrics, but not two views of one column."""
    step = max(1, len(log) // _MOST_CORRELATED)
    values = {metric.code: study.series(log, metric).values[::step].copy() for metric in metrics}
    pairs = [
        correlate(a.code, b.code, values[a.code], values[b.code])
        for a, b in combinations(metrics, 2)
        if a.column != b.column
    ]
    return with_holm([correlation for correlation in pairs if correlation is not None])


def _combined(per_log: Sequence[Sequence[Correlation]]) -> tuple[Correlation, ...]:
    pairs: dict[tuple[str, str], list[Correlation]] = {}
    for correlations in per_log:
        for correlation in correlations:
            pairs.setdefault((correlation.first, correlation.second), []).append(correlation)
    return with_holm([combine(parts) for parts in pairs.values()])


def _across(study: Study, logs: Sequence[LogResult], group: str) -> Mapping[str, Summary]:
    """Sums up the means of a group's logs, each log one observation."""
    of_group = [log.metrics for log in logs if log.group == group]
    across = {}
    for metric in study.options.metrics:
        known = (summaries[metric.code].mean for summaries in of_group if metric.code in summaries)
        means = np.array([mean for mean in known if mean is not None], np.float64)
        across[metric.code] = summarise_independent(means, metric.kind, study.options.confidence)
    return across


def _comparisons(study: Study) -> tuple[Comparison, ...]:
    if len(study.groups) != 2:
        return ()
    comparisons = [
        compare(metric.code, *study.compared(metric), study.options.confidence, paired=bool(study.pairs))
        for metric in study.options.metrics
    ]
    if study.options.ranked:
        comparisons.sort(key=lambda item: -item.effect)
        # Untested, lest it make the others' adjusted p-values larger, is what says nothing of the rover.
        comparisons = [
            replace(item, test=None, p=None, smallest_p=None) if _says_nothing(item) else item
            for item in comparisons
        ]
    return with_holm(comparisons)


def _says_nothing(item: Comparison) -> bool:
    """Whether it is a column that is the same in all logs, or of the recording's health."""
    return (item.hedges_g is None and not item.difference) or item.code in HEALTH
