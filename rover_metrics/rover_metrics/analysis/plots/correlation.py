"""The correlations of all pairs of metrics as one picture, with the sign as a colour and as a number."""

from collections.abc import Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from rover_metrics.analysis.metric import Metric
from rover_metrics.analysis.plots.style import WIDTH
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.tables.sheets import probability

_DARK = 0.62  # |rho| beyond which text on the cell must be white


def draw_correlation(
    correlations: Sequence[Correlation], metrics: Sequence[Metric], alpha: float
) -> Figure | None:
    """Draws the lower triangle of the correlation matrix.

    Args:
        correlations: The pairs there are.
        metrics: Rows and columns, in order.
        alpha: Adjusted p-value above which a cell is left white.

    Returns:
        The figure; None if there is no pair.
    """
    if not correlations:
        return None
    present = [m for m in metrics if any(m.code in (c.first, c.second) for c in correlations)]
    codes = [metric.code for metric in present]
    side = max(2.4, 0.9 + 0.5 * len(codes))
    figure = Figure(figsize=(min(WIDTH, side + 2.2), side), layout="constrained")
    axes = figure.add_subplot()
    for item in correlations:
        _draw_cell(axes, codes.index(item.first), codes.index(item.second), item, alpha)
    _frame(axes, present)
    axes.set_title(
        "Spearman's rho within logs, Holm-adjusted p below it\n"
        f"white: p of {alpha:.2g} or more, may be chance",
        loc="left",
    )
    scale = mpl.cm.ScalarMappable(mpl.colors.Normalize(-1, 1), "PuOr")
    figure.colorbar(scale, ax=axes, shrink=0.6, label="rho", ticks=np.linspace(-1, 1, 5))
    return figure


def _draw_cell(axes: Axes, column: int, line: int, item: Correlation, alpha: float) -> None:
    p = item.p if item.p_holm is None else item.p_holm
    sure = p < alpha
    colour = mpl.colormaps["PuOr"]((item.rho + 1) / 2) if sure else "white"
    cell = Rectangle(
        (column - 0.5, line - 0.5), 1, 1, facecolor=colour, edgecolor="#999999", linewidth=0.6
    )
    axes.add_patch(cell)
    ink = "white" if sure and abs(item.rho) > _DARK else "black" if sure else "#666666"
    axes.text(column, line - 0.12, f"{item.rho:+.2f}", ha="center", va="center", fontsize=8, color=ink)
    axes.text(column, line + 0.24, probability(p), ha="center", va="center", fontsize=6, color=ink)


def _frame(axes: Axes, metrics: Sequence[Metric]) -> None:
    n = len(metrics)
    axes.set_xlim(-0.5, n - 1.5)
    axes.set_ylim(n - 0.5, 0.5)
    axes.set_xticks(range(n - 1), [metric.code for metric in metrics[:-1]])
    axes.set_yticks(range(1, n), [f"{metric.title}  {metric.code}" for metric in metrics[1:]])
    axes.grid(visible=False)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
