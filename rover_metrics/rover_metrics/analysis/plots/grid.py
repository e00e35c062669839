"""Small multiples: one panel a metric, two beside each other."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.metric import Metric
from rover_metrics.analysis.plots.style import WIDTH, axis_label

_PANEL_HEIGHT = 1.75  # inches


def metric_grid(metrics: Sequence[Metric]) -> tuple[Figure, list[tuple[Metric, Axes]]]:
    """Lay out one panel per metric, its title saying what it shows and in which unit."""
    columns = min(2, len(metrics))
    lines = -(-len(metrics) // columns)
    figure = Figure(figsize=(WIDTH, 1.1 + _PANEL_HEIGHT * lines), layout="constrained")
    panels = []
    for number, metric in enumerate(metrics):
        axes = figure.add_subplot(lines, columns, number + 1)
        axes.set_title(axis_label(metric), loc="left")
        panels.append((metric, axes))
    return figure, panels
