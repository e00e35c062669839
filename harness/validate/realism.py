"""A 10-minute run of a rover beside two logs that were recorded of it.

What counts is the shape: how the values of a CSV row are spread. The yardstick is how far two recorded
logs lie apart, for they too come from different places and drives.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Column, Table
from scipy.stats import wasserstein_distance

from harness.spec.run import Run
from harness.validate.run_log import COLUMNS, RUN, Log, drive, read_log
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS

ROUGH = DEFAULT_THRESHOLDS.rough_terrain_threshold  # [m/s2]
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
        run: Ours.
    """

    logs: dict[str, Log]
    distances: dict[str, Distances]
    run: Run = RUN

    @property
    def missed(self) -> list[str]:
        """Columns in which ours lies too far away."""
        return [column for column, distance in self.distances.items() if not distance.passed]


def compare(paths: Sequence[Path], robot: str, seed: int) -> Comparison:
    """Returns how a run of ours lies to two logs.

    Args:
        paths: Of the two logs.
        robot: Name of the rover that they are of.
        seed: Of our run.

    Raises:
        UsageError: A log cannot be read.
    """
    recorded = [read_log(path) for path in paths]
    run = RUN.alone(robot=robot, seed=seed)
    ours = drive(run)
    titles = ["ours", *(path.stem.removeprefix("metrics_log_") for path in paths)]
    return Comparison(
        logs=dict(zip(titles, [ours, *recorded], strict=True)),
        distances={column: distances(ours, recorded, column) for column in COLUMNS},
        run=run,
    )


def distances(ours: Log, recorded: Sequence[Log], column: str) -> Distances:
    """Returns how far a column of ours lies from two recorded ones, and those from each other.

    Args:
        ours: The log of our run.
        recorded: The two logs.
        column: Name of the column.
    """
    values, (first, second) = ours[column], (log[column] for log in recorded)
    pairs = ((values, first), (values, second), (first, second))
    near, far, between = (float(wasserstein_distance(*pair)) for pair in pairs)
    return Distances((near, far), between)


def print_comparison(console: Console, comparison: Comparison) -> None:
    """Prints percentiles of all logs and the distances between them."""
    run = comparison.run
    console.print(
        f"ours: {run.rover.robot} on {run.world.terrain}, difficulty {run.world.difficulty:g}, noise "
        f"{run.rover.noise}, {run.duration:.0f} s, speeds as recorded (harness/validate/run_log.py)"
    )
    console.print(_spread_table(comparison))
    console.print(_distance_table(comparison))


def _spread_table(comparison: Comparison) -> Table:
    figures = (Column(name, justify="right") for name in ("p5", "p50", "p95", f"above {ROUGH:g}"))
    table = Table("column", "log", *figures, title="How the rows are spread", title_justify="left")
    for column, unit in COLUMNS.items():
        for title, log in comparison.logs.items():
            values = log[column]
            spread = (f"{p:.2f}" for p in np.percentile(values, (5, 50, 95)))
            share = f"{100 * np.mean(values > ROUGH):.1f} %" if unit == "m/s2" else ""
            table.add_row(f"{column}, {unit}", title, *spread, share)
    return table


def _distance_table(comparison: Comparison) -> Table:
    first, second = list(comparison.logs)[1:]
    headings = ("recorded", "ours, 1st", "ours, 2nd", "ratio")
    table = Table(
        "column",
        *(Column(heading, justify="right") for heading in headings),
        "verdict",
        title="Wasserstein distances",
        title_justify="left",
        caption=f"recorded: from {first} (1st) to {second} (2nd); ratio: of the farther one of ours to "
        f"that, at most {WITHIN:g}",
    )
    for column, distances in comparison.distances.items():
        table.add_row(
            column,
            *(f"{distance:.3f}" for distance in (distances.recorded, *distances.ours)),
            f"{distances.ratio:.2f}",
            "ok" if distances.passed else "MISS",
        )
    return table
