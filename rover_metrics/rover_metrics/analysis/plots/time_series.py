"""A metric over time: one figure, each log a curve, its rows behind it."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.logs.time_axis import TimeAxis
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots import style as styling
from rover_metrics.analysis.plots.curves import Smoothing, smoothed, thinned, upper_limit
from rover_metrics.analysis.study import Member, Study

_MOST_NAMED = 12  # logs; more make a legend that nobody reads
_MOST_WITH_ROWS = 3  # logs; the rows of more hide each other


def draw_time_series(study: Study, metric: Metric) -> Figure | None:
    """Draws a metric of all logs over time; None if no log has a value."""
    figure = Figure(figsize=(styling.WIDTH, 3.6), layout="constrained")
    axes = figure.add_subplot()
    members = study.with_metric(metric)
    show_rows = metric.kind is Kind.LEVEL and len(members) <= _MOST_WITH_ROWS
    drawn: list[Floats] = []
    for member in members:
        style = _style(study, member, axes)
        for x, y in study.episodes(member, metric):
            at, mean = smoothed(x, y, *_smoothing(metric))
            if show_rows:
                axes.plot(*thinned(x, y), color=style["color"], alpha=0.3, linewidth=0.6, zorder=2)
            axes.plot(*thinned(at, mean), **style, zorder=3)
            style["label"] = None  # a log is named once
            drawn.append(y if show_rows else mean)
    if not any(np.isfinite(values).any() for values in drawn):
        return None
    bounds = study.bounds(metric)
    _limit(axes, metric, drawn, styling.highest_bound(bounds))
    axes.margins(x=0)
    styling.draw_thresholds(axes, bounds)
    axes.set_xlabel(study.options.axis.label)
    axes.set_ylabel(metric.label)
    axes.set_title(_title(metric, study.options.axis, show_rows=show_rows), loc="left")
    styling.draw_legend(figure, axes)
    return figure


def _limit(axes: Axes, metric: Metric, values: list[Floats], threshold: float) -> None:
    """Ends the y axis where it shows the bulk and the thresholds, and says what lies beyond."""
    end, beyond, highest = upper_limit(values, 1.15 * threshold)
    if metric.kind is Kind.FLAG:
        end = min(end, 105.0)
    axes.set_ylim(0, end)
    if beyond:
        text = f"{beyond} value{'s' if beyond > 1 else ''} above the axis, the highest {highest:.4g}"
        axes.annotate(text, (1, 1), xycoords="axes fraction", ha="right", va="top", fontsize=7.5)


def _style(study: Study, member: Member, axes: Axes) -> dict[str, Any]:
    """Returns look and name of a log's curve; of many logs, those of their group, named once."""
    if len(study.groups) == 1 and len(study.members) <= _MOST_NAMED:
        return styling.look(study.members.index(member)) | {"label": member.label}
    named = axes.get_legend_handles_labels()[1]
    label = None if member.group in named else member.group
    return styling.look(study.groups.index(member.group)) | {"linewidth": 0.9, "label": label}


def _smoothing(metric: Metric) -> tuple[float, Smoothing]:
    """Levels jolt, so the median of few rows; events are rare, so the mean of more."""
    return (0.05, "median") if metric.kind is Kind.LEVEL else (0.1, "mean")


def _title(metric: Metric, axis: TimeAxis, *, show_rows: bool) -> str:
    share, how = _smoothing(metric)
    thin = "each interval" if axis.name == "fixed_interval" else "each row"
    thick = f"running {how} over {100 * share:.0f} % of the episode"
    return f"{metric.title}: {thick}" + (f", thin: {thin}" if show_rows else "")
