"""How every figure looks: fonts, colours that the colour-blind tell apart, thresholds, wording."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from rover_metrics.analysis.metric import Metric
from rover_metrics.analysis.study import Study
from rover_metrics.core.thresholds import THRESHOLD_INFO
from rover_metrics.log.files import whole_file
from rover_metrics.sheet.sheet import spelled

_PANEL_HEIGHT = 1.75  # inches
_MOST_PANELS = 16  # of one figure; more are not seen together

# Okabe & Ito (2008), without the yellow, which paper swallows; black is for thresholds and text.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
LINES = ("-", "--", "-.", (0, (1, 1.2)), (0, (5, 1, 1, 1, 1, 1)))
MARKERS = ("o", "s", "^", "D", "v", "P")
_LONGEST_TITLE = 44  # letters above a panel
THRESHOLD_LINE = "#333333"
WIDTH = 7.2  # inches, a text column of A4
DPI = 200
NAME_HEIGHT, NAME_ROOM = 10.0, 13.5  # [pt] of a threshold's name, and between two lines that have one

STYLE: Any = {  # not Mapping[str, Any]: matplotlib lists every key in its type
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.5,
    "legend.frameon": False,
    "pdf.fonttype": 42,  # text stays text
    "svg.fonttype": "none",
}


def look(number: int) -> dict[str, Any]:
    """Returns colour and line style of the n-th curve; thirty differ."""
    return {
        "color": COLOURS[number % len(COLOURS)],
        "linestyle": LINES[(number + number // len(COLOURS)) % len(LINES)],
    }


def draw_thresholds(axes: Axes, bounds: Mapping[str, Sequence[float]]) -> None:
    """Draws the thresholds that bound a metric, by name, and says which they are, one at each end.

    Logs of several sessions may have had several values of one. Names stand in rows above lines that
    are too close to have them in between, and then say how the lines are dashed.
    """
    lines, (bottom, top) = sorted(v for values in bounds.values() for v in values), axes.get_ylim()
    room = NAME_ROOM * (top - bottom) / (72.0 * axes.bbox.height / axes.figure.dpi)
    are_close = any(0.0 < high - low < room for low, high in pairwise(lines))
    look: dict[str, Any] = {"va": "bottom", "fontsize": 7.5, "color": THRESHOLD_LINE, "zorder": 4}
    look["bbox"] = {"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.5}
    look |= {"xycoords": ("axes fraction", "data"), "textcoords": "offset points"}
    stacked = Counter[float]()  # names above a line
    looks = ("dashed", 1.0, "right"), ("dotted", 0.0, "left")
    for (name, values), (dash, end, side) in zip(bounds.items(), looks, strict=False):
        unit, remark = spelled(THRESHOLD_INFO[name].unit), f"({dash}) " if are_close else ""
        named: dict[float, list[str]] = {}
        for value in values:
            axes.axhline(value, color=THRESHOLD_LINE, linewidth=1.0, linestyle=dash, zorder=1.5)
            named.setdefault(_free_above(value, lines, room), []).append(f"{value:g}")
        for place, some in named.items():
            text = f" {name.replace('_', ' ')} {', '.join(some)} {unit} {remark}"
            axes.annotate(text, (end, place), (0, 1.5 + NAME_HEIGHT * stacked[place]), ha=side, **look)
            stacked[place] += 1


def say_that_nothing_is_there(axes: Axes) -> None:
    """Says in a panel that no log has a value of its metric."""
    axes.set(xticks=[], yticks=[])
    axes.annotate("no value", (0.5, 0.5), xycoords="axes fraction", ha="center", color=THRESHOLD_LINE)


def _free_above(value: float, lines: Sequence[float], room: float) -> float:
    """Returns the lowest of some sorted lines, from a value on, above which there is room."""
    for line in lines:
        if value < line < value + room:
            value = line
    return value


def lower_end(lowest: float, highest: float) -> float:
    """Returns where a y axis begins whose values lie between these: at 0, as lengths are to be compared.

    Below the values where some are negative, and where all lie in the upper half, as those do that
    gravity is a part of: from 0 on, their difference would not be seen.
    """
    margin = 0.1 * (highest - lowest)
    is_hidden = margin > 0 and 2 * (lowest - margin) > highest
    return lowest - margin if lowest < 0 or is_hidden else 0.0


def ends_of(bounds: Mapping[str, Sequence[float]]) -> tuple[float, float]:
    """Returns the smallest and the largest threshold, which a figure has to show; inf and 0 for none."""
    values = [value for each in bounds.values() for value in each]
    return min(values, default=math.inf), max(values, default=0.0)


def save(figure: Figure, folder: Path, name: str) -> list[Path]:
    """Writes a figure as PNG and PDF, and returns both files.

    Args:
        figure: Is changed: a $ in its texts is a $.
        folder: Exists.
        name: Without an extension; never made from the name of a log.
    """
    for text in figure.findobj(Text):
        text.set_parse_math(False)  # a $ in a file name is a $; rcParams can say so only from 3.6 on
    paths = [folder / f"{name}.png", folder / f"{name}.pdf"]
    with whole_file(paths[0]) as png, whole_file(paths[1]) as pdf:
        figure.savefig(png, format="png", dpi=DPI)
        figure.savefig(pdf, format="pdf", metadata={"CreationDate": None})  # same log, same bytes
    return paths


def draw_legend(figure: Figure, axes: Axes) -> None:
    """Names the curves below the figure, in as many columns as fit its width."""
    handles, labels = axes.get_legend_handles_labels()
    columns = legend_columns(labels)
    place = _legend_place(figure, -(-len(labels) // columns))
    figure.legend(handles, labels, loc=place, ncol=columns, handlelength=3)  # ncols: from 3.6 on


def _legend_place(figure: Figure, lines: int) -> Literal["outside lower center", "lower center"]:
    """Returns the place below the axes, which matplotlib knows by name from 3.7 on.

    An older one gets a blank label of so many lines, for which its layout makes room.
    """
    if mpl.__version_info__ >= (3, 7):
        return "outside lower center"
    figure.supxlabel("\n" * lines, fontsize=STYLE["legend.fontsize"], linespacing=1.6)
    return "lower center"


def legend_columns(labels: Sequence[str]) -> int:
    """Returns how many legend columns fit the width of a figure."""
    longest = max((len(label) for label in labels), default=1)
    return max(1, min(len(labels), int(95 / (longest + 8))))


def metric_grid(
    study: Study, order: Sequence[str] = ()
) -> tuple[Figure, list[tuple[Metric, Axes]], str]:
    """Lays out one panel per metric that a log has, its title saying what it shows and in which unit.

    Args:
        study: The logs.
        order: Codes in the order of the panels, if it is not that of the study.

    Returns:
        The figure, the panels, and a remark for its title if not every metric has one.
    """
    metrics = [metric for metric in study.options.metrics if study.with_metric(metric)]
    every, places = len(metrics), {code: place for place, code in enumerate(order)}
    metrics = sorted(metrics, key=lambda metric: places.get(metric.code, len(places)))[:_MOST_PANELS]
    remark = f" (the first {len(metrics)} of {every} metrics)" if every > len(metrics) else ""
    columns = min(2, len(metrics))
    lines = -(-len(metrics) // 2)
    figure = Figure(figsize=(WIDTH, 1.1 + _PANEL_HEIGHT * lines), layout="constrained")
    panels = []
    for number, metric in enumerate(metrics):
        axes = figure.add_subplot(lines, columns, number + 1)
        axes.set_title(shortened(metric.label, _LONGEST_TITLE), loc="left")
        panels.append((metric, axes))
    return figure, panels, remark


def shortened(text: str, longest: int) -> str:
    """Returns a text of at most `longest` letters; a column of a log may be called anything."""
    return text if len(text) <= longest else f"{text[: longest - 1]}…"
