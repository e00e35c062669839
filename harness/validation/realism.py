"""A 10-minute run of rover_zero4wd beside the logs that RoboTerrain recorded of it.

What counts is the shape: how the values of a CSV row are spread. The yardstick is how far two recorded
logs lie apart, for they too came from different places and drives.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from harness.validation.recorded import COLUMNS, Log, read_log, wasserstein
from harness.validation.run_log import CONFIG, drive

WITHIN = 2.0  # times the yardstick


@dataclass(frozen=True, slots=True)
class Distances:
    """Wasserstein distances of one column, in its unit; `ours` to each recorded log."""

    ours: tuple[float, float]
    recorded: float

    @property
    def ratio(self) -> float:
        """Ours to the farther recorded log, over recorded to recorded."""
        return max(self.ours) / self.recorded

    @property
    def passed(self) -> bool:
        """Whether ours is within the factor of both."""
        return self.ratio <= WITHIN


@dataclass(frozen=True)
class Comparison:
    """Our run and two recorded ones.

    Attributes:
        logs: By title, ours first.
        distances: By column.
    """

    logs: dict[str, Log]
    distances: dict[str, Distances]

    @property
    def missed(self) -> list[str]:
        """Columns in which ours lies too far away."""
        return [column for column, distance in self.distances.items() if not distance.passed]


def compare(paths: Sequence[Path], seed: int) -> Comparison:
    """Drives our run and compares it with two logs.

    Raises:
        UsageError: A log cannot be read.
    """
    recorded = [read_log(path) for path in paths]
    ours = drive(replace(CONFIG, seed=seed))
    titles = ["ours", *(path.stem.removeprefix("metrics_log_") for path in paths)]
    return Comparison(
        logs=dict(zip(titles, [ours, *recorded], strict=True)),
        distances={column: distances(ours, recorded, column) for column in COLUMNS},
    )


def distances(ours: Log, recorded: Sequence[Log], column: str) -> Distances:
    """How far a column of ours lies from two recorded ones, and those from each other."""
    first, second = (log[column] for log in recorded)
    return Distances(
        ours=(wasserstein(ours[column], first), wasserstein(ours[column], second)),
        recorded=wasserstein(first, second),
    )
