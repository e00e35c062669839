"""A metric over time: one figure, each log a curve, its rows behind it.

Curves are smoothed, thinned to what paper can show, with limits that outliers cannot set.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats, Log, TimeAxis
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots import style as styling
from rover_metrics.analysis.study import Study
from rover_metrics.errors import counted

MOST_POINTS = 4000  # two a pixel at 200 dpi
_FEWEST_SMOOTHED = 9  # rows
_MOST_SMOOTHED = 20_000
_MOST_NAMED = 12  # logs; more make a legend that nobody reads
_MOST_WITH_ROWS = 3  # logs; the rows of more hide each other
_LONGEST_LABEL = 60  # letters beside the axis
_MARK: Any = {"s": 25, "edgecolor": "white", "linewidth": 0.6, "zorder": 5, "clip_on": False}

Smoothing = Literal["mean", "median"]


def draw_time_series(study: Study, metric: Metric) -> Figure | None:
    """Draws a metric of all logs over time; None if no log has a value."""
    figure = Figure(figsize=(styling.WIDTH, 3.6), layout="constrained")
    axes = figure.add_subplot()
    logs = study.with_metric(metric)
    show_rows = metric.kind is Kind.LEVEL and len(logs) <= _MOST_WITH_ROWS
    lowest = _lowest_rows(study, metric)
    drawn: list[Floats] = [np.array([y]) for _, y in lowest.values()]
    for log in logs:
        style = _style(study, log, axes, lowest)
        if log.label in lowest:
            axes.scatter(*lowest[log.label], marker="v", color=style["color"], **_MARK)
        for x, y in study.episodes(log, metric):
            at, mean = smoothed(x, y, *_smoothing(metric))
            if show_rows:
                axes.plot(*thinned(x, y), color=style["color"], alpha=0.3, linewidth=0.6, zorder=2)
            axes.plot(*thinned(at, mean), **style, zorder=3)
            style["label"] = None  # a log is named once
            drawn.append(y if show_rows else mean)
    values = np.concatenate([np.zeros(0), *(each[np.isfinite(each)] for each in drawn)])
    if not values.size:
        return None
    bounds = study.bounds(metric)
    _limit(axes, metric, values, bounds)
    axes.margins(x=0)
    styling.draw_thresholds(axes, bounds)
    axes.set_xlabel(study.options.axis.label)
    axes.set_ylabel(styling.shortened(metric.label, _LONGEST_LABEL))
    title = _title(metric, study.options.axis, show_rows=show_rows)
    axes.set_title(title + ("; \u25bc: lowest" if lowest else ""), loc="left")
    styling.draw_legend(figure, axes)
    return figure


def _lowest_rows(study: Study, metric: Metric) -> dict[str, tuple[float, float]]:
    """Returns where each of several logs is lowest, by its label: a running median hides that."""
    logs = study.with_metric(metric)
    if metric.kind is not Kind.LEVEL or len(logs) < 2:
        return {}
    lowest = {}
    for log in logs:
        x, y = map(np.concatenate, zip(*study.episodes(log, metric), strict=True))
        if np.isfinite(y).any():
            row = np.nanargmin(y)
            lowest[log.label] = float(x[row]), float(y[row])
    return lowest


def _limit(axes: Axes, metric: Metric, values: Floats, bounds: Mapping[str, Sequence[float]]) -> None:
    """Ends the y axis where it shows the bulk and the thresholds, and says what lies beyond."""
    low, high = styling.ends_of(bounds)
    top, above, highest = upper_limit(values, 1.15 * high)
    top = min(top, 105.0) if metric.kind is Kind.FLAG else top
    lowest = min(float(values.min()), low)
    bottom = -upper_limit(-values, 0.0)[0] if lowest < 0 else styling.lower_end(lowest, highest)
    axes.set_ylim(bottom, top)
    for count, side, extreme, y in (
        (above, "above", f"highest {highest:.4g}", 1),
        (int((values < bottom).sum()), "below", f"lowest {lowest:.4g}", 0),
    ):
        if count:
            text = f"{counted(count, 'value')} {side} the axis, the {extreme}"
            place: Literal["top", "bottom"] = "top" if y else "bottom"
            axes.annotate(text, (1, y), xycoords="axes fraction", ha="right", va=place, fontsize=7.5)


def _style(
    study: Study, log: Log, axes: Axes, lowest: Mapping[str, tuple[float, float]]
) -> dict[str, Any]:
    """Returns look and name of a log's curve; of many logs, those of their group, named once."""
    if len(study.groups) == 1 and len(study.logs) <= _MOST_NAMED:
        name, alike = log.label, [log]
        style = styling.look(study.logs.index(log))
    else:
        name, alike = log.group, [each for each in study.logs if each.group == log.group]
        style = styling.look(study.groups.index(log.group)) | {"linewidth": 0.9}
    least = [lowest[each.label][1] for each in alike if each.label in lowest]
    label = f"{name}, lowest {min(least):.4g}" if least else name
    return style | {"label": None if label in axes.get_legend_handles_labels()[1] else label}


def _smoothing(metric: Metric) -> tuple[float, Smoothing]:
    """Levels jolt, so the median of few rows; events are rare, so the mean of more."""
    return (0.05, "median") if metric.kind is Kind.LEVEL else (0.1, "mean")


def _title(metric: Metric, axis: TimeAxis, *, show_rows: bool) -> str:
    share, how = _smoothing(metric)
    thin = "each interval" if axis.name == "fixed_interval" else "each row"
    thick = f"running {how} over {100 * share:.0f} % of the episode"
    return f"{metric.title}: {thick}" + (f", thin: {thin}" if show_rows else "")


def smoothed(positions: Floats, values: Floats, share: float, how: Smoothing) -> tuple[Floats, Floats]:
    """Returns the mean or median over the nearest rows; NaN where none of them has a value.

    For a long episode, positions and values are the means of short runs of rows.

    Args:
        positions: Those of the rows of an episode.
        values: At those positions.
        share: How much of the episode to take; at least nine rows.
        how: The mean suits rates and shares; the median is not lifted by a single jolt.
    """
    positions, values = _condensed(positions), _condensed(values)
    window = max(_FEWEST_SMOOTHED, round(values.size * share))
    rolling = pd.Series(values).rolling(window, center=True, min_periods=1)
    curve = rolling.mean() if how == "mean" else rolling.median()
    return positions, curve.to_numpy(dtype=np.float64)


def _condensed(values: Floats) -> Floats:
    """Averages runs of equal length so that few enough values remain; a run without any gives NaN."""
    if values.size <= _MOST_SMOOTHED:
        return values
    run = -(-values.size // _MOST_SMOOTHED)
    return np.asarray(pd.Series(values).groupby(np.arange(values.size) // run).mean(), dtype=np.float64)


def thinned(positions: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Returns lowest and highest value of equal runs, so that no peak is lost and files stay small."""
    known = np.isfinite(values)
    positions, values = positions[known], values[known]
    if values.size <= MOST_POINTS:
        return positions, values
    run = -(-values.size // (MOST_POINTS // 2))
    runs = [(begin, values[begin : begin + run]) for begin in range(0, values.size, run)]
    rows = np.unique([begin + end for begin, some in runs for end in (some.argmin(), some.argmax())])
    return positions[rows], values[rows]


def upper_limit(values: Floats, at_least: float) -> tuple[float, int, float]:
    """Chooses where a y axis of finite values ends, so that a few peaks do not flatten all else.

    Returns the end of the axis, at_least or more, how many values lie beyond, and the highest.
    """
    highest = float(values.max())
    usual = float(np.quantile(values, 0.995))
    end = max(1.1 * (usual if highest > 1.5 * usual and usual > 0 else highest), at_least)
    if values.min() >= 0:
        end = end or 1.0
    return end, int((values > end).sum()), highest
