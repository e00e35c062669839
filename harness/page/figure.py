"""Plotly figures as plain JSON values, and what all of them have in common.

A colour that starts with two dashes is a custom property of the page's style sheet, so that one figure
serves light and dark; assets/plots.js puts the value in its place.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

DASHES = {"solid": "", "dash": "6 4", "dashdot": "8 3 2 3", "dot": "2 2"}  # [px], as Plotly draws them


Figure = dict[str, Any]
Trace = dict[str, Any]
Layout = dict[str, Any]

TIMES, MINUS, DASH = "\N{MULTIPLICATION SIGN}", "\N{MINUS SIGN}", "\N{EN DASH}"

METRIC, TRUTH, SCAN, INK, MUTED = "--metric", "--truth", "--scan", "--ink", "--muted"

AXIS: Layout = {
    "gridcolor": "--grid",
    "linecolor": "--line",
    "zeroline": False,
    "showline": True,
    "ticks": "outside",
    "tickcolor": "--line",
    "ticklen": 4,
    "automargin": True,
}


def common_layout(**values: object) -> Layout:
    """A layout with the page's colours and font."""
    return {
        "paper_bgcolor": "--panel",
        "plot_bgcolor": "--panel",
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": INK},
        "hoverlabel": {"bgcolor": "--panel", "bordercolor": "--line", "font": {"color": INK}},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": MUTED, "activecolor": INK},
        "dragmode": "zoom",
        "showlegend": False,  # harness.page.figure makes one that never covers anything
        **values,
    }


def numbers(values: Iterable[float], decimals: int = 3) -> list[float | None]:
    """Rounded for a smaller page; JSON knows neither infinity nor NaN, and Plotly leaves a gap."""
    return [round(value, decimals) if math.isfinite(value) else None for value in values]


@dataclass(frozen=True, slots=True)
class Key:
    """A line of a legend.

    Attributes:
        swatch: "line", "area" or the name of a marker symbol.
        color: Name of a custom property of the style sheet.
        dash: Dash pattern of a line [px].
    """

    name: str
    swatch: str
    color: str
    dash: str = ""


def keys(figure: Figure) -> list[Key]:
    """A key for every name in a figure, in the order of drawing."""
    traces = [_trace_key(trace) for trace in figure["data"] if trace.get("showlegend", True)]
    shapes = [_shape_key(shape) for shape in figure["layout"].get("shapes", ())]
    return list({key.name: key for key in (*traces, *shapes)}.values())


def _trace_key(trace: Trace) -> Key:
    name = trace["name"]
    if "fill" in trace:
        return Key(name, "area", trace["fillcolor"])
    if "lines" in trace["mode"]:
        return _line_key(name, trace["line"])
    marker = trace["marker"]
    return Key(name, marker.get("symbol", "dot"), marker.get("line", marker)["color"])


def _shape_key(shape: dict[str, Any]) -> Key:
    if shape["type"] == "rect":
        return Key(shape["name"], "area", shape["fillcolor"])
    return _line_key(shape["name"], shape["line"])


def _line_key(name: str, line: dict[str, Any]) -> Key:
    return Key(name, "line", line["color"], DASHES[line.get("dash", "solid")])


@dataclass(frozen=True)
class Plot:
    """A figure, named and described.

    Attributes:
        name: Identifies it on the page.
        summary: What it shows, in words, for who cannot see it.
    """

    name: str
    heading: str
    caption: str
    summary: str
    figure: Figure

    @property
    def legend(self) -> list[Key]:
        """What its colours and symbols mean."""
        return keys(self.figure)
