"""The correlations of all pairs of metrics as one picture, with the sign as a colour and as a number."""

from collections.abc import Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from rover_metrics.analysis.metric import Metric
from rover_metrics.analysis.plots.style import WIDTH, shortened
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.sheet.sheet import probability

_MOST_WRITTEN = 14  # metrics; in the cells of more no number can be read
_LONGEST_TICK = 34  # letters
_LONGEST_LEVEL = 5  # letters below a cell, beyond which names stand upright
_DARK = 0.62  # |rho| beyond which text on the cell must be white


def draw_correlation(
    correlations: Sequence[Correlation], metrics: Sequence[Metric], alpha: float
) -> Figure | None:
    """Draws the lower triangle of the correlation matrix; None if there is no pair.

    Args:
        correlations: A cell each.
        metrics: Rows and columns, in this order.
        alpha: From this adjusted p-value on a cell stays white.
    """
    if not correlations:
        return None
    present = [m for m in metrics if any(m.code in (c.first, c.second) for c in correlations)]
    codes = [metric.code for metric in present]
    written = len(codes) <= _MOST_WRITTEN
    side = max(2.4, 0.9 + (0.5 if written else 0.24) * len(codes))
    width = min(WIDTH, side + 2.2) if written else side + 2.2
    figure = Figure(figsize=(width, side), layout="constrained")
    axes = figure.add_subplot()
    for item in correlations:
        place = codes.index(item.first), codes.index(item.second)
        _draw_cell(axes, place, item, alpha, written=written)
    _frame(axes, present)
    below = ", Holm-adjusted p below it" if written else ""
    axes.set_title(
        f"Spearman's rho within logs{below}\nwhite: p (Holm) of {alpha:.2g} or more, may be chance",
        loc="left",
    )
    scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(-1, 1), "PuOr")
    figure.colorbar(scale, ax=axes, shrink=0.6, label="rho", ticks=np.linspace(-1, 1, 5))
    return figure


def _draw_cell(
    axes: Axes, place: tuple[int, int], item: Correlation, alpha: float, *, written: bool
) -> None:
    column, line = place
    p = item.p if item.p_holm is None else item.p_holm
    sure = p < alpha
    colour = mpl.colormaps["PuOr"]((item.rho + 1) / 2) if sure else "white"
    corner = (column - 0.5, line - 0.5)
    axes.add_patch(Rectangle(corner, 1, 1, facecolor=colour, edgecolor="#999999", linewidth=0.6))
    if not written:
        return
    ink = "white" if sure and abs(item.rho) > _DARK else "black" if sure else "#666666"
    look: dict[str, Any] = {"ha": "center", "va": "center", "color": ink}
    axes.text(column, line - 0.12, f"{item.rho:+.2f}", fontsize=8, **look)
    axes.text(column, line + 0.24, probability(p), fontsize=6, **look)


def _frame(axes: Axes, metrics: Sequence[Metric]) -> None:
    n = len(metrics)
    axes.set_xlim(-0.5, n - 1.5)
    axes.set_ylim(n - 0.5, 0.5)
    columns = [shortened(metric.short, _LONGEST_TICK) for metric in metrics[:-1]]
    upright = max(map(len, columns)) > _LONGEST_LEVEL
    axes.set_xticks(range(n - 1), columns, rotation=90 if upright else 0)
    lines = (m.title if m.short == m.title else f"{m.title}  {m.code}" for m in metrics[1:])
    axes.set_yticks(range(1, n), [shortened(line, _LONGEST_TICK) for line in lines])
    axes.grid(visible=False)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
