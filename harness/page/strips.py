"""Strips: a row for each group of runs, a dot for each run, the mean of each row and its interval."""

from collections.abc import Sequence
from html import escape

from harness.page.figure import INK, PANEL, Figure, Layout, Trace, common_layout, numbers, titled

SPREAD = 0.3  # of a row's height: how far its dots lie apart
DECIMALS = 6

Interval = tuple[float, float]


def beside(row: int, place: int, count: int) -> float:
    """Returns where the dot of that place lies, of the `count` of a row."""
    return row + SPREAD * (2 * (place + 0.5) / count - 1)


def dots(
    name: str,
    points: Sequence[tuple[float, float, object]],
    hover: str,
    color: str,
    symbol: str = "circle",
) -> Trace:
    """Returns a dot for each run.

    Args:
        name: In the legend.
        points: The value of each, where it lies (`beside`), and what is said of it.
        hover: Template of the text under the pointer, in which %{customdata} is that.
        color: Name of a custom property of the style sheet.
        symbol: In Plotly's terms.
    """
    return {
        **_markers(name, color, symbol, 8),
        "x": numbers([x for x, _, _ in points], DECIMALS),
        "y": numbers([y for _, y, _ in points]),
        "customdata": [about for _, _, about in points],
        "hovertemplate": f"{hover}<extra></extra>",
    }


def means(name: str, values: Sequence[float | None], intervals: Sequence[Interval | None]) -> Trace:
    """Returns the mean of each row that has one, with its interval, if there is one."""
    known = [
        (index, mean, interval or (mean, mean))
        for index, (mean, interval) in enumerate(zip(values, intervals, strict=True))
        if mean is not None
    ]
    return {
        **_markers(name, INK, "diamond-open", 11),
        "x": numbers([mean for _, mean, _ in known], DECIMALS),
        "y": [index for index, _, _ in known],
        "error_x": {
            "type": "data",
            "symmetric": False,
            "array": numbers([high - mean for _, mean, (_, high) in known], DECIMALS),
            "arrayminus": numbers([mean - low for _, mean, (low, _) in known], DECIMALS),
            "color": INK,
            "thickness": 1.5,
            "width": 4,
        },
        "hovertemplate": "%{x}<extra></extra>",
    }


def strips(
    traces: Sequence[Trace],
    names: Sequence[str],
    title: str,
    shown: Interval,
    limits: Sequence[Layout] = (),
) -> Figure:
    """Returns the figure of some dots and means.

    Args:
        traces: The dots and means.
        names: Of the rows, from the top.
        title: Of the axis of values.
        shown: From which to which value.
        limits: Lines across.
    """
    rows = [escape(name).replace(", ", "<br>") for name in names]
    ticks = {"tickvals": list(range(len(rows))), "ticktext": rows}
    layout = common_layout(
        margin={"l": 10, "r": 14, "t": 24, "b": 44},
        xaxis=titled(title, range=numbers(shown, DECIMALS)),
        yaxis=titled("", range=[len(rows) - 0.5, -0.5], **ticks),
        shapes=list(limits),
    )
    return {"data": list(traces), "layout": layout}


def _markers(name: str, color: str, symbol: str, size: int) -> Trace:
    fill = PANEL if symbol == "circle" else color  # open symbols have no other colour
    marker = {"symbol": symbol, "size": size, "color": fill, "line": {"color": color, "width": 2}}
    return {"type": "scatter", "mode": "markers", "name": name, "marker": marker}
