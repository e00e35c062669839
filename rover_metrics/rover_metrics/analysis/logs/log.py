"""A log in memory: typed columns, episodes, what was odd about the file, and the time axes of plots."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from rover_metrics.analysis.metric import Metric
from rover_metrics.core.thresholds import Thresholds

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
AxisName = Literal["percentage", "fixed_interval", "none"]
AXES: tuple[AxisName, ...] = get_args(AxisName)
DEFAULT_GAP = 10.0  # [s]: ten times the logging period; hand-edited logs lack a row or two at most


@dataclass(frozen=True, eq=False)
class Log:
    """One metrics log; its columns are those that were asked for and exist, one value per row.

    They are NaN where the file has no number or infinity.
    """

    path: Path
    stamps: Floats  # time of each row [s]
    columns: Mapping[str, NDArray[np.floating]]
    starts: Integers  # first row of each episode, ascending; the first is 0
    findings: tuple[str, ...] = ()  # what was odd about the file
    thresholds: Thresholds | None = None  # at the end of its session, if its record has them
    arguments: Mapping[str, Any] = field(default_factory=dict)  # of the harness's run, by name
    label: str = ""  # short, unique in a study
    group: str = ""  # of a study

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


@dataclass(frozen=True)
class TimeAxis:
    """How the rows of an episode are placed in time.

    By percentage of the episode, as one mean per fixed interval, or ("none") as they were recorded.
    """

    name: AxisName = "percentage"
    interval: float = 1.0  # length of a fixed interval [s]

    @property
    def label(self) -> str:
        """What the axis shows, with its unit."""
        if self.name == "percentage":
            return "Share of the episode [%]"
        means = f", means over {self.interval:g} s" if self.name == "fixed_interval" else ""
        return f"Time since the episode began [s]{means}"

    def place(self, stamps: Floats, values: Floats) -> tuple[Floats, Floats]:
        """Returns position and value of the rows of one episode, from their times [s] and values.

        In percent, from 0 to 100; else in seconds since the episode began. Intervals without a value
        are left out, not filled.
        """
        elapsed = stamps - stamps[0]
        if self.name == "fixed_interval":
            return _bin_means(elapsed, values, self.interval)
        length = float(elapsed[-1])
        if self.name == "percentage" and length:
            return elapsed * (100.0 / length), values
        return elapsed, values


def _bin_means(positions: Floats, values: Floats, width: float) -> tuple[Floats, Floats]:
    """Returns beginnings and means of the bins [k width, (k + 1) width) that have a value."""
    known = np.isfinite(values)
    # A thousandth of a bin: 0.3 s in bins of 0.1 s is bin 3, whatever the floats say.
    bins = np.floor(positions[known] / width + 1e-3)
    numbers, member = np.unique(bins, return_inverse=True)
    sums = np.bincount(member, weights=values[known], minlength=numbers.size)
    return numbers * width, sums / np.bincount(member, minlength=numbers.size)


def on_grid(positions: Floats, values: Floats, grid: Floats) -> Floats:
    """Returns an episode on a common grid: means where rows are dense, lines between where sparse.

    Args:
        positions: Where the rows are on the axis, ascending.
        values: One per row; may be NaN.
        grid: Evenly spaced and ascending, in the unit of the positions.

    Returns:
        A value for each place of the grid, NaN beyond the episode's ends.
    """
    width = float(grid[1] - grid[0])
    at, means = _bin_means(positions - grid[0] + width / 2, values, width)
    if not at.size:
        return np.full(grid.size, np.nan)
    return np.asarray(np.interp(grid - grid[0], at, means, left=np.nan, right=np.nan))
