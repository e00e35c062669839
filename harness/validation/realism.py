"""A 10-minute run of rover_zero4wd beside the logs that RoboTerrain recorded of it.

What counts is the shape: how the values of a CSV row are spread. The yardstick is how far two recorded
logs lie apart, for they too came from different places and drives.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from harness.validation.recorded import COLUMNS, Log, read_log, wasserstein
from harness.validation.run_log import CONFIG, drive

ROUGH = 15.0  # [m/s2]: metrics_node's threshold


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


def print_comparison(console: Console, comparison: Comparison) -> None:
    """Prints percentiles of all logs and the distances between them."""
    console.print(
        f"ours: {CONFIG.robot} on {CONFIG.terrain}, difficulty {CONFIG.difficulty:g}, noise "
        f"{CONFIG.noise}, {CONFIG.duration:.0f} s, speeds as recorded (harness/validation/agent.py)"
    )
    console.print(_spread_table(comparison))
    console.print(_distance_table(comparison))


def _spread_table(comparison: Comparison) -> Table:
    table = Table(title="How the rows are spread", title_justify="left")
    table.add_column("column")
    table.add_column("log")
    for heading in ("p5", "p50", "p95", f"above {ROUGH:g}"):
        table.add_column(heading, justify="right")
    for column, unit in COLUMNS.items():
        for title, log in comparison.logs.items():
            values = log[column]
            spread = (f"{p:.2f}" for p in np.percentile(values, (5, 50, 95)))
            share = f"{100 * np.mean(values > ROUGH):.1f} %" if unit == "m/s2" else ""
            table.add_row(f"{column}, {unit}", title, *spread, share)
    return table


def _distance_table(comparison: Comparison) -> Table:
    table = Table(title="Wasserstein distances", title_justify="left")
    table.add_column("column")
    first, second = list(comparison.logs)[1:]
    for heading in ("recorded", "ours, 1st", "ours, 2nd", "ratio"):
        table.add_column(heading, justify="right")
    table.add_column("verdict")
    for column, distances in comparison.distances.items():
        table.add_row(
            column,
            *(f"{distance:.3f}" for distance in (distances.recorded, *distances.ours)),
            f"{distances.ratio:.2f}",
            "ok" if distances.passed else "MISS",
        )
    table.caption = (
        f"recorded: from {first} (1st) to {second} (2nd); ratio: of the farther one of ours to that, "
        f"at most {WITHIN:g}"
    )
    return table
