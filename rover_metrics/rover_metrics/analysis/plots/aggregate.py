"""All episodes of a group as one curve: their mean, and how far it is certain."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy import stats

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.logs.time_axis import TimeAxis, on_grid
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots.style import (
    draw_thresholds,
    highest_bound,
    legend_columns,
    look,
    metric_grid,
)
from rover_metrics.analysis.study import Study

_PERCENT_STEP = 2.0
_STEPS = 60  # of a time axis whose interval nobody chose
_MOST_STEPS = 2000
_FEWEST_FOR_INTERVAL = 3  # episodes; of fewer the band is what they range over


def draw_aggregate(study: Study, axis: TimeAxis) -> Figure | None:
    """Draw the mean over the episodes of each group, one panel a metric.

    Args:
        study: The logs.
        axis: The time axis.

    Returns:
        The figure; None if no log has a value.
    """
    metrics = [metric for metric in study.options.metrics if study.with_metric(metric)]
    if not metrics:
        return None
    figure, panels = metric_grid(metrics)
    grid = _grid(study, axis)
    for metric, axes in panels:
        _draw_panel(axes, study, metric, axis, grid)
    level = f"{100 * study.options.confidence:g} %"
    figure.suptitle(
        f"Mean of the episodes; band: {level} t interval (range if under {_FEWEST_FOR_INTERVAL})",
        fontsize=9.5,
    )
    for _, axes in panels[-2:]:
        axes.set_xlabel(axis.label)
    handles, labels = panels[0][1].get_legend_handles_labels()
    figure.legend(
        handles, labels, loc="outside lower center", ncols=legend_columns(labels), handlelength=3
    )
    return figure


def _grid(study: Study, axis: TimeAxis) -> Floats:
    """Give the positions at which episodes are averaged."""
    if axis.name == "percentage":
        return np.arange(0.0, 100.0 + _PERCENT_STEP / 2, _PERCENT_STEP)
    longest = max(float(np.ptp(m.log.stamps[rows])) for m in study.members for rows in m.log.episodes)
    step = axis.interval if axis.name == "fixed_interval" else max(1.0, longest / _STEPS)
    step = max(step, longest / _MOST_STEPS)
    return np.arange(0.0, max(longest, step) + step / 2, step)


def _draw_panel(axes: Axes, study: Study, metric: Metric, axis: TimeAxis, grid: Floats) -> None:
    top = 0.0
    for number, group in enumerate(study.groups):
        curves = _curves(study, metric, group, axis, grid)
        if curves.size and np.isfinite(curves).any():
            mean, low, high = mean_and_band(curves, study.options.confidence)
            style = look(number)
            axes.fill_between(grid, low, high, color=style["color"], alpha=0.2, linewidth=0)
            axes.plot(
                grid,
                mean,
                **style,
                label=f"{group} ({len(curves)} episode{'s' if len(curves) > 1 else ''})",
            )
            top = max(top, float(np.nanmax(mean)) * 1.4, float(np.nanquantile(high, 0.97)) * 1.1)
    bounds = study.bounds(metric)
    top = min(top, 105.0) if metric.kind is Kind.FLAG else top
    axes.set_ylim(0, max(top, 1.3 * highest_bound(bounds)) or 1.0)
    axes.margins(x=0)
    draw_thresholds(axes, bounds)


def _curves(study: Study, metric: Metric, group: str, axis: TimeAxis, grid: Floats) -> Floats:
    """Give the episodes of a group on the grid, one a row."""
    curves = []
    for member in study.with_metric(metric):
        if member.group == group:
            values = study.series(member.log, metric).values
            for rows in member.log.episodes:
                x, y = axis.place(member.log.stamps[rows], values[rows])
                curves.append(on_grid(x, y, grid))
    return np.array(curves).reshape(-1, grid.size)


def mean_and_band(curves: Floats, confidence: float) -> tuple[Floats, Floats, Floats]:
    """Average curves point by point.

    Args:
        curves: One episode a row, NaN beyond its end.
        confidence: Level of the band.

    Returns:
        Mean, and the band's lower and upper edge: Student's interval where three episodes or more
        have a value, else their range; NaN where none has.
    """
    known = np.isfinite(curves)
    n = known.sum(axis=0)
    some = n > 0
    total = np.where(known, curves, 0.0).sum(axis=0)
    mean = np.divide(total, n, out=np.full(n.shape, np.nan), where=some)
    squares = np.where(known, (curves - mean) ** 2, 0.0).sum(axis=0)
    enough = n >= _FEWEST_FOR_INTERVAL
    freedom = np.where(enough, n - 1, 1)
    half = stats.t.ppf((1 + confidence) / 2, freedom) * np.sqrt(squares / freedom / np.maximum(n, 1))
    lowest = np.where(some, np.where(known, curves, np.inf).min(axis=0), np.nan)
    highest = np.where(some, np.where(known, curves, -np.inf).max(axis=0), np.nan)
    return mean, np.where(enough, mean - half, lowest), np.where(enough, mean + half, highest)
