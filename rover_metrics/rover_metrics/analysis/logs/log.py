"""A log in memory: typed columns, episodes, and what was odd about the file."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.metric import Metric
from rover_metrics.core.thresholds import Thresholds

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Log:
    """One metrics log.

    Attributes:
        stamps: Time of each row [s].
        columns: The metric columns that were asked for and exist, one value a row. NaN where the
            file has no number or infinity.
        starts: First row of each episode, ascending; the first is 0.
        thresholds: The thresholds at the end of its session; None if its record does not have them.
        arguments: Arguments of the harness's run by name (robot, terrain, seed, ...); empty without one.
    """

    path: Path
    stamps: Floats
    columns: Mapping[str, NDArray[np.floating]]
    starts: Integers
    findings: tuple[str, ...] = ()
    thresholds: Thresholds | None = None
    arguments: Mapping[str, Any] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.stamps)

    def has(self, metric: Metric) -> bool:
        """Returns whether the log has the columns that a metric needs."""
        return metric.extended_column in self.columns or all(
            column in self.columns for column in metric.columns
        )

    @property
    def episodes(self) -> list[slice]:
        """The rows of each episode."""
        ends = [*self.starts[1:], len(self)]
        return [slice(int(a), int(b)) for a, b in zip(self.starts, ends, strict=True)]

    @property
    def duration(self) -> float:
        """Time logged, without the gaps between episodes [s]."""
        return float(sum(self.stamps[rows][-1] - self.stamps[rows][0] for rows in self.episodes))
