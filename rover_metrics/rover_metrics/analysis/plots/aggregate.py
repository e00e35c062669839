"""All episodes of a group as one curve: their mean, and how far it is certain."""

import math

import numpy as np
import pandas as pd
import scipy  # loads a part of it when that is named
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats, on_grid
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots import style as styling
from rover_metrics.analysis.study import Study
from rover_metrics.errors import counted

_PERCENT_STEP = 2.0
_STEPS = 60  # of a time axis whose interval nobody chose
_MOST_STEPS = 2000
_FEWEST_FOR_INTERVAL = 3  # episodes; of fewer the band is what they range over


def draw_aggregate(study: Study) -> Figure | None:
    """Draws the mean over the episodes of each group, a panel per metric; None if no log has a value."""
    figure, panels, remark = styling.metric_grid(study)
    if not panels:
        return None
    grid = _grid(study)
    for metric, axes in panels:
        _draw_panel(axes, study, metric, grid)
    level = f"{100 * study.options.confidence:g} %"
    figure.suptitle(
        f"Mean of the episodes; band: {level} t interval (range if under {_FEWEST_FOR_INTERVAL})"
        + remark,
        fontsize=9.5,
    )
    for _, axes in panels[-2:]:
        axes.set_xlabel(study.options.axis.label)
    styling.draw_legend(figure, panels[0][1])
    return figure


def _grid(study: Study) -> Floats:
    """Returns the positions at which episodes are averaged."""
    axis = study.options.axis
    if axis.name == "percentage":
        return np.arange(0.0, 100.0 + _PERCENT_STEP / 2, _PERCENT_STEP)
    longest = max(float(np.ptp(log.stamps[rows])) for log in study.logs for rows in log.episodes)
    step = axis.interval if axis.name == "fixed_interval" else max(1.0, longest / _STEPS)
    step = max(step, longest / _MOST_STEPS)
    return np.arange(0.0, max(longest, step) + step / 2, step)


def _draw_panel(axes: Axes, study: Study, metric: Metric, grid: Floats) -> None:
    top, lowest = 0.0, math.inf
    for number, group in enumerate(study.groups):
        curves = _curves(study, metric, group, grid)
        if curves.size and np.isfinite(curves).any():
            mean, low, high = mean_and_band(curves, study.options.confidence)
            style = styling.look(number)
            axes.fill_between(grid, low, high, color=style["color"], alpha=0.2, linewidth=0)
            axes.plot(grid, mean, **style, label=f"{group} ({counted(len(curves), 'episode')})")
            top = max(top, float(np.nanmax(mean)) * 1.4, float(np.nanquantile(high, 0.97)) * 1.1)
            # A band that leads below 0 where no value does is cut: there is no such clearance or speed.
            end = min(float(np.nanmin(mean)), float(np.nanquantile(low, 0.03)))
            lowest = min(lowest, max(end, 0.0) if np.nanmin(curves) >= 0.0 else end)
    if math.isinf(lowest):
        styling.say_that_nothing_is_there(axes)
        return
    bounds = study.bounds(metric)
    top = min(top, 105.0) if metric.kind is Kind.FLAG else top
    end = max(top, 1.3 * styling.ends_of(bounds)[1]) or (1.0 if lowest >= 0 else -0.1 * lowest)
    axes.set_ylim(min(0.0, 1.1 * lowest), end)
    axes.margins(x=0)
    styling.draw_thresholds(axes, bounds)


def _curves(study: Study, metric: Metric, group: str, grid: Floats) -> Floats:
    """Returns the episodes of a group on the grid, one per row."""
    curves = [
        on_grid(x, y, grid)
        for log in study.with_metric(metric)
        if log.group == group
        for x, y in study.episodes(log, metric)
    ]
    return np.array(curves).reshape(-1, grid.size)


def mean_and_band(curves: Floats, confidence: float) -> tuple[Floats, Floats, Floats]:
    """Returns the mean of curves point by point, and the lower and upper edge of a band around it.

    The band is Student's interval where three episodes or more have a value, else their range; NaN
    where none has. A curve is an episode in a row, NaN beyond its end.
    """
    frame = pd.DataFrame(curves)
    n, mean = frame.count(), frame.mean()
    half = scipy.stats.t.ppf((1 + confidence) / 2, n.clip(lower=2) - 1) * frame.sem()
    is_enough = n >= _FEWEST_FOR_INTERVAL
    low, high = (mean - half).where(is_enough, frame.min()), (mean + half).where(is_enough, frame.max())
    return mean.to_numpy(), low.to_numpy(), high.to_numpy()
