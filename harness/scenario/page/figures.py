"""A quantity in every cell of a scenario: each run a dot, their mean with its interval, the limits."""

import math
from collections.abc import Iterator, Sequence
from html import escape

from harness.page.figure import (
    COLUMN,
    DASH,
    INK,
    METRIC,
    PANEL,
    TRUTH,
    Figure,
    Layout,
    Plot,
    Trace,
    common_layout,
    level,
    numbers,
    titled,
)
from harness.scenario.comparison import Cell, Compared, Comparisons
from harness.scenario.verdict import outcome_of
from rover_metrics.analysis.statistics.summary import Interval

DECIMALS = 6
SPREAD = 0.3  # of a row's height: how far its dots lie apart
ROOM = 0.06  # of a plot's width beside what is in it
AS_EXPECTED, NOT_AS_EXPECTED = "run as expected", "run not as expected"


def plots_of(name: str, compared: Comparisons) -> Iterator[Plot]:
    """Yields the pass rates of a scenario's cells, then a plot per quantity, all named `name`-..."""
    yield Plot(
        f"{name}-passed", "Pass rate of each cell, in percent", _passed(compared), "Runs that pass"
    )
    for index, quantity in enumerate(compared.quantities):
        rows = ((row.cell.name, row.summary.mean) for row in quantity.rows)
        means = "; ".join(f"{cell}: {DASH if mean is None else f'{mean:.4g}'}" for cell, mean in rows)
        summary = f"{quantity.heading}, mean of each cell: {means}"
        yield Plot(f"{name}-{index}", summary, _strips(quantity), quantity.heading)


def height(cells: Sequence[Cell]) -> str:
    """Returns how high the plots of a scenario are, in the page's terms."""
    lines = max(1, *(len(cell.values) for cell in cells))
    return f"{5.5 + len(cells) * (1.3 + 0.9 * lines):.1f}rem"


def _passed(compared: Comparisons) -> Figure:
    cells = compared.cells
    rates = [100 * cell.good / len(cell.attempts) for cell in cells]
    intervals = [(100 * cell.interval[0], 100 * cell.interval[1]) for cell in cells]
    mean = _means("pass rate with its 95 % interval", rates, intervals)
    asked = compared.verdict.attempts[0].case.scenario.pass_rate
    limits = [] if asked is None else [_limit("pass rate of all runs, at least", 100 * asked.min, "%")]
    return _figure([mean], limits, cells, "%", (-ROOM * 100, 100 * (1 + ROOM)))


def _strips(quantity: Compared) -> Figure:
    cells = [row.cell for row in quantity.rows]
    summaries = [row.summary for row in quantity.rows]
    means, intervals = [s.mean for s in summaries], [s.interval for s in summaries]
    limits = list(_limits(quantity))
    dots = [_dots(quantity, good=good) for good in (True, False)]
    shown = [value for row in quantity.rows for value in row.values if math.isfinite(value)]
    shown += [end for interval in intervals if interval for end in interval]
    shown += [limit["x0"] for limit in limits]
    traces = [trace for trace in dots if trace["x"]]
    if any(mean is not None for mean in means):
        traces.append(_means("mean with its 95 % interval", means, intervals))
    return _figure(traces, limits, cells, quantity.unit, _around(shown))


def _around(shown: Sequence[float]) -> Interval:
    low, high = min(shown, default=0.0), max(shown, default=1.0)
    room = ROOM * (high - low) or max(abs(high), 1.0) * ROOM
    return low - room, high + room


def _dots(quantity: Compared, *, good: bool) -> Trace:
    points = [
        (value, index + SPREAD * (2 * (number + 0.5) / len(row.values) - 1), attempt.case.run.seed)
        for index, row in enumerate(quantity.rows)
        for number, (value, attempt) in enumerate(zip(row.values, row.cell.attempts, strict=True))
        if math.isfinite(value) and outcome_of(attempt).is_good == good
    ]
    color, symbol = (METRIC, "circle") if good else (TRUTH, "x-thin-open")
    return {
        **_markers(AS_EXPECTED if good else NOT_AS_EXPECTED, color, symbol, 8),
        "x": numbers([x for x, _, _ in points], DECIMALS),
        "y": numbers([y for _, y, _ in points]),
        "customdata": [seed for _, _, seed in points],
        "hovertemplate": "seed %{customdata}: %{x}<extra></extra>",
    }


def _means(name: str, means: Sequence[float | None], intervals: Sequence[Interval | None]) -> Trace:
    known = [
        (index, mean, interval or (mean, mean))
        for index, (mean, interval) in enumerate(zip(means, intervals, strict=True))
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


def _markers(name: str, color: str, symbol: str, size: int) -> Trace:
    line = {"color": color, "width": 2}
    fill = PANEL if symbol == "circle" else color  # open symbols have no other colour
    marker = {"symbol": symbol, "size": size, "color": fill, "line": line}
    return {"type": "scatter", "mode": "markers", "name": name, "marker": marker}


def _limits(quantity: Compared) -> Iterator[Layout]:
    """What a bound allows; of a share its smallest, of a tolerance nothing: each run has a baseline."""
    bound, unit = quantity.bound, quantity.unit
    if bound.share is not None:
        yield _limit("at least", bound.share, "")
        return
    for name, value in (("at least", bound.min), ("at most", bound.max)):
        if value is not None:
            yield _limit(name, value, unit)


def _limit(name: str, value: float, unit: str) -> Layout:
    dash = "dash" if "least" in name else "dot"
    text = f"{name} {value:g} {unit}".rstrip()
    return level(text, COLUMN | {"x0": value, "x1": value}, dash, TRUTH)


def _figure(
    traces: list[Trace], limits: list[Layout], cells: Sequence[Cell], title: str, shown: Interval
) -> Figure:
    rows = [escape(cell.name).replace(", ", "<br>") for cell in cells]
    layout = common_layout(
        margin={"l": 10, "r": 14, "t": 24, "b": 44},
        xaxis=titled(title, range=numbers(shown, DECIMALS)),
        yaxis=titled(
            "", range=[len(cells) - 0.5, -0.5], tickvals=list(range(len(cells))), ticktext=rows
        ),
        shapes=limits,
    )
    return {"data": traces, "layout": layout}
