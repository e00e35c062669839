"""Legends, as HTML beside the plots: there they wrap, follow the colours and are read aloud."""

from dataclasses import dataclass
from typing import Any

from harness.page.figure import Figure, Trace

DASHES = {"solid": "", "dash": "6 4", "dashdot": "8 3 2 3", "dot": "2 2"}  # [px], as Plotly draws them


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
