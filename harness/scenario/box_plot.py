"""A box plot of each quantity: a box per cell, a dot per run."""

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from harness.base.errors import UsageError
from harness.scenario.comparison import Compared, Comparisons
from rover_metrics.analysis.plots.style import COLOURS, DPI, STYLE, WIDTH

BOX, HEAD = 0.32, 0.9  # [inches] for a box, and around those of a quantity
SPREAD = 0.25  # of a box's height, over which its dots lie


def box_plots(several: Sequence[Comparisons], file: Path) -> None:
    """Draws all quantities of all scenarios below each other.

    Boxes reach from quartile to quartile with the median, whiskers to the last run within 1.5
    interquartile ranges; each run is a dot.

    Raises:
        UsageError: The file cannot be written.
    """
    quantities = [quantity for compared in several for quantity in compared.quantities]
    heights = [HEAD + BOX * len(quantity.rows) for quantity in quantities]
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(WIDTH, sum(heights)), layout="constrained")
        axes = figure.subplots(len(quantities), squeeze=False, height_ratios=heights)[:, 0]
        for one, quantity in zip(axes, quantities, strict=True):
            _draw(one, quantity)
        try:
            figure.savefig(file, dpi=DPI)
        except OSError as error:
            raise UsageError(f"--plot {file} cannot be written: {error.strerror}") from error


def _draw(axes: mpl.axes.Axes, quantity: Compared) -> None:
    cells = [row.cell for row in quantity.rows]  # those that are compared, below each other
    rows = sorted(quantity.rows, key=lambda row: cells.index(row.reference))
    known = [np.array(row.values)[np.isfinite(row.values)] for row in rows]
    names = [f"{row.cell.name} (n = {len(v)})" for row, v in zip(rows, known, strict=True)]
    axes.boxplot(known, orientation="horizontal", tick_labels=names, widths=0.6, showfliers=False)
    for place, values in enumerate(known, 1):
        at = place + SPREAD * (2.0 * (np.arange(len(values)) + 0.5) / max(1, len(values)) - 1.0)
        axes.plot(values, at, "o", markersize=3, color=COLOURS[0], alpha=0.7)
    axes.invert_yaxis()
    axes.set_xlabel(quantity.heading, parse_math=False)
