"""A 10-minute run of a rover beside two logs that were recorded of it.

What counts is the shape: how the values of a CSV row are spread. The yardstick is how far two recorded
logs lie apart, for they too come from different places and drives.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import scipy  # loads a part of it when that is named
from rich.console import Console

from harness.base.errors import UsageError, repeated
from harness.spec.run import Run
from harness.validate.run_log import COLUMNS, RUN, Log, drive, read_log
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet

ROUGH = DEFAULT_THRESHOLDS.rough_terrain_threshold  # [m/s2]
WITHIN = 2.0  # times the yardstick


@dataclass(frozen=True, slots=True)
class Distances:
    """Wasserstein distances of one column, in its unit; `ours` to each recorded log."""

    ours: tuple[float, float]
    recorded: float

    @property
    def ratio(self) -> float:
        """Distance of ours to the farther recorded log over that of both recorded ones; inf if alike."""
        return max(self.ours) / self.recorded if self.recorded > 0.0 else math.inf

    @property
    def passed(self) -> bool:
        """Whether ours is within the factor of both."""
        return self.ratio <= WITHIN


@dataclass(frozen=True)
class Comparison:
    """Our run and two recorded ones."""

    logs: dict[str, Log]  # by title, ours first
    distances: dict[str, Distances]  # by column
    run: Run = RUN

    @property
    def missed(self) -> list[str]:
        """Columns in which ours lies too far away."""
        return [column for column, distance in self.distances.items() if not distance.passed]


def compare(paths: Sequence[Path], robot: str, seed: int) -> Comparison:
    """Compares a run of ours with two recorded logs.

    Args:
        paths: Of the two logs.
        robot: Name of the rover that they are of.
        seed: Of our run.

    Raises:
        UsageError: A log cannot be read, or both are one.
    """
    if len({*map(Path.resolve, paths)}) < len(paths):
        raise UsageError(f"--realism takes two logs, {paths[0]} is given twice; name another")
    recorded = [read_log(path) for path in paths]
    run = RUN.alone(robot=robot, seed=seed)
    ours = drive(run)
    titles = ["ours", *(path.stem.removeprefix("metrics_log_") for path in paths)]
    if repeated(titles):
        titles = ["ours", *map(str, paths)]
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
    logs = [log[column] for log in (ours, *recorded)]
    near, far, between = (
        float(scipy.stats.wasserstein_distance(*pair)) for pair in combinations(logs, 2)
    )
    return Distances((near, far), between)


def print_comparison(console: Console, comparison: Comparison) -> None:
    """Prints percentiles of all logs and the distances between them."""
    run = comparison.run
    console.print(
        f"ours: {run.rover.robot} on {run.world.terrain}, difficulty {run.world.difficulty:g}, noise "
        f"{run.rover.noise}, {run.duration:.0f} s, speeds as recorded (harness/validate/run_log.py)"
    )
    console.print(*terminal(sheets_of(comparison), console.width), sep="\n", highlight=False)


def sheets_of(comparison: Comparison) -> tuple[Sheet, Sheet]:
    """Returns percentiles of all logs, and the distances between them, as tables."""
    return Sheet.of(_spread(comparison), "How the rows are spread"), _distances(comparison)


def _spread(comparison: Comparison) -> Iterator[dict[str, str]]:
    for column, unit in COLUMNS.items():
        for title, log in comparison.logs.items():
            p5, p50, p95 = (f"{p:.2f}" for p in np.percentile(log[column], (5, 50, 95)))
            share = f"{100 * np.mean(log[column] > ROUGH):.1f} %" if unit == "m/s2" else ""
            about = {"column": f"{column}, {unit}", "log": title, "p5": p5, "p50": p50, "p95": p95}
            yield about | {f"above {ROUGH:g}": share}


def _distances(comparison: Comparison) -> Sheet:
    first, second = list(comparison.logs)[1:]
    rows = (
        {
            "column": column,
            "recorded": f"{of.recorded:.3f}",
            "ours, 1st": f"{of.ours[0]:.3f}",
            "ours, 2nd": f"{of.ours[1]:.3f}",
            "ratio": f"{of.ratio:.2f}",
            "verdict": "ok" if of.passed else "MISS",
        }
        for column, of in comparison.distances.items()
    )
    caption = (
        f"recorded: from {first} (1st) to {second} (2nd); ratio: of the farther one of ours to that"
    )
    return Sheet.of(rows, "Wasserstein distances", caption=f"{caption}, at most {WITHIN:g}")
