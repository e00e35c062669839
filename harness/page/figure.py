"""Plotly figures as plain JSON values: their traces, axes and legends.

A colour that starts with two dashes is a custom property of the page's style sheet, so that one figure
serves light and dark; assets/plots.js puts the value in its place.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

DASHES = {"solid": "", "dash": "6 4", "dashdot": "8 3 2 3", "dot": "2 2"}  # [px], as Plotly draws them

Figure = dict[str, Any]
Trace = dict[str, Any]
Layout = dict[str, Any]

TIMES, MINUS, DASH = "\N{MULTIPLICATION SIGN}", "\N{MINUS SIGN}", "\N{EN DASH}"

METRIC, TRUTH, SCAN, INK, MUTED = "--metric", "--truth", "--scan", "--ink", "--muted"
BAND, PANEL = "--band", "--panel"

COLUMN = {"yref": "paper", "y0": 0.0, "y1": 1.0}  # a shape from bottom to top

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
    """Returns a layout with the page's colours and font, and these values."""
    return {
        "paper_bgcolor": PANEL,
        "plot_bgcolor": PANEL,
        "font": {"family": "system-ui, sans-serif", "size": 12, "color": INK},
        "hoverlabel": {"bgcolor": PANEL, "bordercolor": "--line", "font": {"color": INK}},
        "modebar": {"bgcolor": "rgba(0,0,0,0)", "color": MUTED, "activecolor": INK},
        "dragmode": "zoom",
        "showlegend": False,  # `keys` makes one that never covers anything
        "margin": {"l": 60, "r": 14, "t": 30, "b": 44},
        **values,
    }


def titled(text: str, **values: object) -> Layout:
    """Returns an axis with a title, its unit in brackets, and these values."""
    return AXIS | {"title": {"text": text}, **values}


def numbers(values: ArrayLike, decimals: int = 3) -> list[float | None]:
    """Returns rounded values for a smaller page; None, which Plotly leaves out, for inf and NaN."""
    plain = np.asarray(values, dtype=np.float64).tolist()
    return [round(value, decimals) if math.isfinite(value) else None for value in plain]


def line(
    name: str,
    x: ArrayLike,
    y: ArrayLike,
    color: str = METRIC,
    *,
    hover: str | None = None,
    **style: object,
) -> Trace:
    """Returns a curve.

    Args:
        name: In the legend.
        x: Shape (n,).
        y: Shape (n,).
        color: Name of a custom property of the style sheet.
        hover: Template of the text under the pointer; the curve does not react to it if None.
        style: Of the line, in Plotly's terms: dash, width [px], shape.
    """
    return {
        "type": "scatter",
        "mode": "lines",
        "name": name,
        "x": numbers(x, 4),
        "y": numbers(y, 4),
        "line": {"color": color, "width": 2, **style},
        **({"hoverinfo": "skip"} if hover is None else {"hovertemplate": f"{hover}<extra></extra>"}),
    }


def points(name: str, x: ArrayLike, y: ArrayLike, marker: Layout, hover: str | None = None) -> Trace:
    """Returns marks.

    Args:
        name: In the legend.
        x: Shape (n,).
        y: Shape (n,).
        marker: In Plotly's terms.
        hover: Template of the text under the pointer; Plotly's own if None.
    """
    look = {"type": "scatter", "mode": "markers", "name": name}
    trace = look | {"x": numbers(x), "y": numbers(y), "marker": marker}
    return trace if hover is None else trace | {"hovertemplate": f"{hover}<extra></extra>"}


def band(name: str, x: ArrayLike, low: ArrayLike, high: ArrayLike) -> list[Trace]:
    """Returns the area between two curves.

    Args:
        name: In the legend.
        x: Shape (n,).
        low: Shape (n,).
        high: Shape (n,).
    """
    edges = [line(name, x, y, BAND, width=0) for y in (low, high)]
    return [edges[0] | {"showlegend": False}, edges[1] | {"fill": "tonexty", "fillcolor": BAND}]


def level(name: str, place: Layout, dash: str, color: str = INK) -> Layout:
    """Returns a straight line across a plot, as one of its shapes.

    Args:
        name: In the legend.
        place: Ends of the line, in Plotly's terms.
        dash: One of DASHES.
        color: Name of a custom property of the style sheet.
    """
    return {"type": "line", "name": name, "line": {"color": color, "width": 1.5, "dash": dash}, **place}


@dataclass(frozen=True, slots=True)
class Key:
    """A line of a legend."""

    name: str
    swatch: str  # "line", "area", "hatch", "cross" or the name of a marker symbol
    color: str  # name of a custom property of the style sheet
    dash: str = ""  # dash pattern of a line [px]


def keys(figure: Figure) -> list[Key]:
    """Returns a key for every name in a figure, in the order of drawing."""
    drawn = [*figure["data"], *figure["layout"].get("shapes", ())]
    shown = (_key(item) for item in drawn if item.get("showlegend", True))
    return list({key.name: key for key in shown}.values())


def _key(item: Trace | Layout) -> Key:
    if "fillpattern" in item:
        pattern = item["fillpattern"]
        return Key(item["name"], "cross" if pattern["shape"] == "x" else "hatch", pattern["fgcolor"])
    if "fillcolor" in item:
        return Key(item["name"], "area", item["fillcolor"])
    if "lines" in item.get("mode", "lines"):
        drawn = item["line"]
        return Key(item["name"], "line", drawn["color"], DASHES[drawn.get("dash", "solid")])
    marker = item["marker"]
    return Key(item["name"], marker.get("symbol", "dot"), marker.get("line", marker)["color"])


@dataclass(frozen=True)
class Plot:
    """A figure, named and described."""

    name: str  # identifies it on the page
    summary: str  # what it shows, as text for readers who cannot see it
    figure: Figure
    heading: str = ""  # above it; empty where the page has one, as is the caption below it
    caption: str = ""

    @property
    def legend(self) -> list[Key]:
        """What its colours and symbols mean."""
        return keys(self.figure)
