"""The comparison with recorded logs on the terminal."""

import numpy as np
from rich.console import Console
from rich.table import Table

from harness.validation.realism import WITHIN, Comparison
from harness.validation.recorded import COLUMNS
from harness.validation.run_log import CONFIG

ROUGH = 15.0  # [m/s2]: metrics_node's threshold


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
