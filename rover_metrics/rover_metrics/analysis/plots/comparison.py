"""Groups side by side: every observation a point, the mean with its interval; or logs as boxes."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind, Metric
from rover_metrics.analysis.plots.style import MARKERS, draw_thresholds, highest_bound, look, metric_grid
from rover_metrics.analysis.result import Result
from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.summary import t_interval
from rover_metrics.analysis.study import Study
from rover_metrics.analysis.tables.sheets import probability

_MOST_TICKS = 12
_LINE = 115  # characters that fit below the panels


def draw_comparison(study: Study, result: Result) -> Figure | None:
    """Draws the two groups of a study; without groups, the distribution of rows in each log.

    Returns None if no log has a value.
    """
    figure, panels = metric_grid(study)
    if not panels:
        return None
    level = f"{100 * result.confidence:g} %"
    if result.comparisons:
        by_code = {comparison.code: comparison for comparison in result.comparisons}
        for metric, axes in panels:
            _draw_groups(axes, study, metric, by_code[metric.code])
        title = f"Each point one {result.unit}; line: mean, bar: {level} t interval; p: Holm-adjusted"
    else:
        for metric, axes in panels:
            _draw_logs(axes, study, metric)
        title = "Rows of each log; box: quartiles, whiskers: 5 % to 95 %; bars: share of rows, rate"
        _name_logs(figure, study)
    figure.suptitle(title, fontsize=9.5)
    return figure


def _draw_groups(axes: Axes, study: Study, metric: Metric, comparison: Comparison) -> None:
    groups = [study.observations(metric, group) for group in study.groups]
    for place, values in enumerate(groups):
        colour = look(place)["color"]
        spread = np.linspace(-0.15, 0.15, values.size) if values.size > 1 else np.zeros(values.size)
        axes.plot(
            place + spread,
            values,
            MARKERS[place],
            color=colour,
            alpha=0.7,
            markersize=5,
            markeredgewidth=0,
            clip_on=False,
            zorder=3,
        )
        if values.size:
            mean = float(values.mean())
            axes.hlines(mean, place - 0.28, place + 0.28, color=colour, linewidth=2)
            interval = t_interval(values, mean, study.options.confidence)
            if interval is not None:
                axes.vlines(place + 0.28, *interval, color=colour, linewidth=2)
    axes.set_xticks(range(len(groups)), study.groups)
    axes.set_xlim(-0.6, 1.6)
    axes.set_ylim(0, _top(axes, groups))
    axes.grid(visible=False, axis="x")
    effect = "" if comparison.hedges_g is None else f", g = {comparison.hedges_g:+.2f}"
    p = comparison.p_holm
    verdict = "no test" if p is None else f"p {'' if p < 0.001 else '= '}{probability(p)}{effect}"
    axes.set_title(verdict, loc="right", fontsize=8, pad=4)
    axes.set_title(axes.get_title(loc="left").replace(" [", "\n["), loc="left")


def _top(axes: Axes, groups: Sequence[Floats]) -> float:
    """Ends the axis at the intervals, or soon above the points: intervals of two points are endless."""
    highest = max((float(values.max()) for values in groups if values.size), default=0.0)
    return min(axes.get_ylim()[1], 2 * highest) if highest > 0 else 1.0


def _draw_logs(axes: Axes, study: Study, metric: Metric) -> None:
    for place, member in enumerate(study.members):
        if not member.log.has(metric):
            continue
        values, weights = study.series(member.log, metric).finite()
        colour = look(place)["color"]
        if values.size and metric.kind is Kind.LEVEL:
            _draw_box(axes, place, values, colour)
        elif values.size:
            axes.bar(place, np.average(values, weights=weights), 0.6, color=colour, alpha=0.8)
    ticks = range(0, len(study.members), -(-len(study.members) // _MOST_TICKS))
    axes.set_xticks(ticks, [str(place + 1) for place in ticks])
    axes.set_xlim(-0.6, len(study.members) - 0.4)
    bounds = study.bounds(metric)
    axes.set_ylim(0, max(axes.get_ylim()[1], 1.3 * highest_bound(bounds)))
    axes.grid(visible=False, axis="x")
    draw_thresholds(axes, bounds)


def _draw_box(axes: Axes, place: int, values: Floats, colour: str) -> None:
    low, first, middle, third, high = np.quantile(values, [0.05, 0.25, 0.5, 0.75, 0.95])
    axes.vlines(place, low, high, color=colour, linewidth=1.2)
    axes.bar(place, third - first, 0.5, first, color=colour, alpha=0.8)
    axes.hlines(middle, place - 0.25, place + 0.25, color="#111111", linewidth=1.6)


def _name_logs(figure: Figure, study: Study) -> None:
    names = [f"{place + 1}: {member.label}" for place, member in enumerate(study.members)]
    if len(names) > _MOST_TICKS:
        names = [*names[: _MOST_TICKS - 1], "and so on"]
    per_line = max(1, int(_LINE / (max(map(len, names)) + 4)))
    lines = [names[i : i + per_line] for i in range(0, len(names), per_line)]
    figure.set_figheight(figure.get_figheight() + 0.15 * (len(lines) - 1))
    figure.supxlabel("\n".join("    ".join(line) for line in lines), fontsize=8)
