"""Plotly figures as plain JSON values, and what all of them have in common.

A colour that starts with two dashes is a custom property of the page's style sheet, so that one figure
serves light and dark; assets/report.js puts the value in its place.
"""

import math
from collections.abc import Iterable
from typing import Any

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
        "showlegend": False,  # harness.page.legend makes one that never covers anything
        **values,
    }


def numbers(values: Iterable[float], decimals: int = 3) -> list[float | None]:
    """Rounded for a smaller page; JSON knows neither infinity nor NaN, and Plotly leaves a gap."""
    return [round(value, decimals) if math.isfinite(value) else None for value in values]
