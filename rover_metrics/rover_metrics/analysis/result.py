"""The outcome of an analysis as values, which turn into JSON."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Literal

from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.statistics.summary import Summary
from rover_metrics.log.files import json_safe

Unit = Literal["log", "episode"]


@dataclass(frozen=True)
class LogResult:
    """What there is to say of one log.

    Attributes:
        label: Short name, unique among the logs.
        rows: Usable rows.
        duration: Time logged [s].
        metrics: By code; a metric the log has no column for is missing.
        per_metre: Rates per metre driven, by code, where they make sense.
        outliers: Values beyond the fences, by code.
    """

    label: str
    path: str
    group: str
    rows: int
    duration: float
    episodes: int
    findings: tuple[str, ...]
    metrics: Mapping[str, Summary]
    per_metre: Mapping[str, float]
    outliers: Mapping[str, int]
    correlations: tuple[Correlation, ...]


@dataclass(frozen=True)
class Skipped:
    """A file that could not be analysed, and why."""

    path: str
    reason: str


@dataclass(frozen=True)
class Result:
    """The outcome of an analysis.

    Attributes:
        confidence: Level of every interval.
        outliers_removed: Whether values beyond the fences were left out.
        iqr_multiplier: Where the fences stand.
        unit: What was one observation in the comparison.
        groups: Names of the groups: one, or two that are compared.
        across: By group and code, the means of the logs as independent observations.
        correlations: Combined over the logs.
        comparisons: Second group against the first, one a metric.
        titles: What each metric reports, with its unit, by code.
        notes: What to know before the comparisons are believed.
    """

    confidence: float
    outliers_removed: bool
    iqr_multiplier: float
    unit: Unit
    groups: tuple[str, ...]
    logs: tuple[LogResult, ...]
    across: Mapping[str, Mapping[str, Summary]]
    correlations: tuple[Correlation, ...]
    comparisons: tuple[Comparison, ...] = ()
    titles: Mapping[str, str] = field(
        default_factory=lambda: {metric.code: metric.label for metric in METRICS.values()}
    )
    notes: tuple[str, ...] = ()
    skipped: tuple[Skipped, ...] = ()
    files: tuple[str, ...] = ()

    def to_json(self) -> str:
        """Returns everything as strict JSON; a number that does not exist is null."""
        return json.dumps(json_safe(asdict(self)), indent=2, ensure_ascii=False, allow_nan=False)
