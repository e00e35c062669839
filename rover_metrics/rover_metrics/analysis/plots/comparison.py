"""Groups side by side: every observation a point, the mean with its interval; or logs as boxes."""

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.outcome import Result
from rover_metrics.analysis.plots import style as styling
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.summary import t_interval
from rover_metrics.analysis.study import Study
from rover_metrics.sheet.sheet import probability

_MOST_TICKS = 12
_POINT: Any = {"alpha": 0.7, "markersize": 5, "markeredgewidth": 0, "clip_on": False, "zorder": 3}
_LINE = 115  # characters that fit below the panels
_TITLE_LINE = 90  # above them


def draw_comparison(study: Study, result: Result) -> Figure | None:
    """Draws the two groups of a study; without groups, the distribution of rows in each log.

    Returns None if no log has a value.
    """
    figure, panels, remark = styling.metric_grid(study, [item.code for item in result.comparisons])
    if not panels:
        return None
    level = f"{100 * result.confidence:g} %"
    if result.comparisons:
        by_code = {comparison.code: comparison for comparison in result.comparisons}
        for metric, axes in panels:
            _draw_groups(axes, study, metric, by_code[metric.code])
        paired = "grey: pairs; " if study.pairs else ""
        how = f"{paired}line: mean, bar: {level} t interval; p: Holm-adjusted"
        title = f"Each point one {result.unit}; {how}"
    else:
        for metric, axes in panels:
            _draw_logs(axes, study, metric)
        title = "Rows of each log; box: quartiles, whiskers: 5 % to 95 %; dots: share of rows, rate"
        _name_logs(figure, study)
    notes = [line for note in result.notes for line in textwrap.wrap(note, _TITLE_LINE)]
    figure.set_figheight(figure.get_figheight() + 0.16 * len(notes))
    figure.suptitle("\n".join([title + remark, *notes]), fontsize=9.5)
    return figure


def _draw_groups(axes: Axes, study: Study, metric: Metric, comparison: Comparison) -> None:
    groups = study.compared(metric)
    if comparison.paired:
        places = [spread + place for place, spread in enumerate(map(_spread, groups))]
        axes.plot(places, groups, color="#999999", linewidth=0.6, zorder=1.8)
    for place, values in enumerate(groups):
        if not values.size:  # an empty line, not clipped, would reach to the figure's corner
            continue
        colour, mark = styling.look(place)["color"], styling.MARKERS[place]
        axes.plot(place + _spread(values), values, mark, color=colour, **_POINT)
        mean = float(values.mean())
        axes.hlines(mean, place - 0.28, place + 0.28, color=colour, linewidth=2)
        interval = t_interval(values, mean, study.options.confidence)
        if interval is not None:
            axes.vlines(place + 0.28, *interval, color=colour, linewidth=2)
    axes.set_title(axes.get_title(loc="left").replace(" [", "\n["), loc="left")
    if not any(values.size for values in groups):
        styling.say_that_nothing_is_there(axes)
        return
    axes.set_xticks(range(len(groups)), study.groups)
    axes.set_xlim(-0.6, 1.6)
    axes.set_ylim(*_limits(axes, groups))
    axes.grid(visible=False, axis="x")
    effect = "" if comparison.hedges_g is None else f", g = {comparison.hedges_g:+.2f}"
    p = comparison.p_holm
    verdict = "no test" if p is None else f"p {'' if p < 0.001 else '= '}{probability(p)}{effect}"
    axes.set_title(verdict, loc="right", fontsize=8, pad=4)


def _spread(values: Floats) -> Floats:
    """Returns how far aside each point stands, so that none hides another."""
    return np.linspace(-0.15, 0.15, values.size) if values.size > 1 else np.zeros(values.size)


def _limits(axes: Axes, groups: Sequence[Floats]) -> tuple[float, float]:
    """Ends the axis at the intervals, or soon beyond the points: intervals of two points are endless."""
    values = np.concatenate(groups)
    if not values.any():
        return 0.0, 1.0
    low, high = (float(end) for end in axes.get_ylim())
    lowest, highest = float(values.min()), float(values.max())
    bottom = styling.lower_end(lowest, highest)
    reach = highest - lowest if bottom else max(highest, -lowest)
    return (max(low, lowest - reach) if bottom else 0.0), min(high, highest + reach)


def _draw_logs(axes: Axes, study: Study, metric: Metric) -> None:
    shown: list[float] = []
    for place, log in enumerate(study.logs):
        if not log.has(metric):
            continue
        values, weights = study.series(log, metric).finite()
        colour = styling.look(place)["color"]
        if values.size and metric.kind is Kind.LEVEL:
            _draw_box(axes, place, values, colour)
            shown += [*np.quantile(values, [0.05, 0.95])]
        elif values.size:
            shown.append(float(np.average(values, weights=weights)))
            axes.plot(place, shown[-1], "o", color=colour, clip_on=False, zorder=3)
    ticks = range(0, len(study.logs), -(-len(study.logs) // _MOST_TICKS))
    axes.set_xticks(ticks, [str(place + 1) for place in ticks])
    axes.set_xlim(-0.6, len(study.logs) - 0.4)
    if not shown:
        styling.say_that_nothing_is_there(axes)
        return
    bounds = study.bounds(metric)
    lowest, highest = styling.ends_of(bounds)
    bottom = styling.lower_end(min(lowest, *shown), max(shown))
    top = axes.get_ylim()[1]
    if not bottom:
        top = max(top, 1.3 * highest)
    axes.set_ylim(bottom, top)
    axes.grid(visible=False, axis="x")
    shown_bounds = {name: [v for v in values if v < top] for name, values in bounds.items()}
    styling.draw_thresholds(axes, shown_bounds)


def _draw_box(axes: Axes, place: int, values: Floats, colour: str) -> None:
    low, first, middle, third, high = np.quantile(values, [0.05, 0.25, 0.5, 0.75, 0.95])
    axes.vlines(place, low, high, color=colour, linewidth=1.2)
    axes.bar(place, third - first, 0.5, first, color=colour, alpha=0.8)
    axes.hlines(middle, place - 0.25, place + 0.25, color="#111111", linewidth=1.6)


def _name_logs(figure: Figure, study: Study) -> None:
    names = [f"{place + 1}: {log.label}" for place, log in enumerate(study.logs)]
    if len(names) > _MOST_TICKS:
        names = [*names[: _MOST_TICKS - 1], "and so on"]
    per_line = max(1, int(_LINE / (max(map(len, names)) + 4)))
    lines = [names[i : i + per_line] for i in range(0, len(names), per_line)]
    figure.set_figheight(figure.get_figheight() + 0.15 * (len(lines) - 1))
    figure.supxlabel("\n".join("    ".join(line) for line in lines), fontsize=8)
