"""A metric over time: one figure, each log a curve, its rows behind it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.logs.time_axis import TimeAxis
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots.curves import Smoothing, smoothed, thinned, upper_limit
from rover_metrics.analysis.plots.style import (
    WIDTH,
    axis_label,
    draw_thresholds,
    highest_bound,
    legend_columns,
    look,
)
from rover_metrics.analysis.study import Member, Study

_MOST_NAMED = 12  # logs; more make a legend that nobody reads
_MOST_WITH_ROWS = 3  # logs; the rows of more hide each other


def draw_time_series(study: Study, metric: Metric, axis: TimeAxis) -> Figure | None:
    """Draw a metric of all logs over time.

    Args:
        study: The logs.
        metric: What to draw.
        axis: The time axis.

    Returns:
        The figure; None if no log has a value.
    """
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    axes = figure.add_subplot()
    members = study.with_metric(metric)
    rows: list[Floats] = []
    means: list[Floats] = []
    show_rows = metric.kind is Kind.LEVEL and len(members) <= _MOST_WITH_ROWS
    for number, member in enumerate(study.members):
        if member in members:
            style, label = _style(study, number, axes)
            drawn = _draw_log(
                axes,
                study,
                member,
                metric,
                axis,
                style=style,
                label=label,
                show_rows=show_rows,
            )
            rows += drawn[0]
            means += drawn[1]
    if not any(np.isfinite(mean).any() for mean in means):
        return None
    bounds = study.bounds(metric)
    _limit(axes, metric, rows if show_rows else means, highest_bound(bounds))
    axes.margins(x=0)
    draw_thresholds(axes, bounds)
    axes.set_xlabel(axis.label)
    axes.set_ylabel(axis_label(metric))
    axes.set_title(_title(metric, axis, show_rows=show_rows), loc="left")
    _legend(figure, axes)
    return figure


def _draw_log(
    axes: Axes,
    study: Study,
    member: Member,
    metric: Metric,
    axis: TimeAxis,
    *,
    style: dict[str, Any],
    label: str | None,
    show_rows: bool,
) -> tuple[list[Floats], list[Floats]]:
    """Draw the episodes of a log, over each other; gives the values and the means drawn."""
    series = study.series(member.log, metric)
    rows: list[Floats] = []
    means: list[Floats] = []
    for episode in member.log.episodes:
        x, y = axis.place(member.log.stamps[episode], series.values[episode])
        at, mean = smoothed(x, y, *_smoothing(metric))
        if show_rows:
            axes.plot(*thinned(x, y), color=style["color"], alpha=0.3, linewidth=0.6, zorder=2)
        axes.plot(*thinned(at, mean), label=None if means else label, **style, zorder=3)
        rows.append(y)
        means.append(mean)
    return rows, means


def _limit(axes: Axes, metric: Metric, values: list[Floats], threshold: float) -> None:
    """End the y axis where it shows the bulk and the thresholds, and say what lies beyond."""
    end, beyond, highest = upper_limit(values, 1.15 * threshold)
    if metric.kind is Kind.FLAG:
        end = min(end, 105.0)
    axes.set_ylim(0, end)
    if beyond:
        text = f"{beyond} value{'s' if beyond > 1 else ''} above the axis, the highest {highest:.4g}"
        axes.annotate(text, (1, 1), xycoords="axes fraction", ha="right", va="top", fontsize=7.5)


def _style(study: Study, number: int, axes: Axes) -> tuple[dict[str, Any], str | None]:
    """Give the look of a log's curve and its name in the legend; of many logs that of their group."""
    member = study.members[number]
    if len(study.groups) == 1 and len(study.members) <= _MOST_NAMED:
        return look(number), member.label
    named = axes.get_legend_handles_labels()[1]
    style = look(study.groups.index(member.group)) | {"linewidth": 0.9}
    return style, None if member.group in named else member.group


def _smoothing(metric: Metric) -> tuple[float, Smoothing]:
    """Levels jolt, so the median of few rows; events are rare, so the mean of more."""
    return (0.05, "median") if metric.kind is Kind.LEVEL else (0.1, "mean")


def _title(metric: Metric, axis: TimeAxis, *, show_rows: bool) -> str:
    share, how = _smoothing(metric)
    thin = "each interval" if axis.name == "fixed_interval" else "each row"
    thick = f"running {how} over {100 * share:.0f} % of the episode"
    return f"{metric.title}: {thick}" + (f", thin: {thin}" if show_rows else "")


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=legend_columns(labels), handlelength=3
    )
