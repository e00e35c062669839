"""A quantity in every cell of a scenario: each run a dot, their mean with its interval, the limits."""

import math
from collections.abc import Iterator, Sequence

from harness.page.figure import COLUMN, DASH, METRIC, TRUTH, Figure, Layout, Plot, Trace, level
from harness.page.strips import beside, dots, means, strips
from harness.scenario.comparison import Cell, Compared, Comparisons
from harness.scenario.verdict import outcome_of
from rover_metrics.analysis.statistics.summary import Interval

ROOM = 0.06  # of a plot's width beside what is in it
AS_EXPECTED, NOT_AS_EXPECTED = "run as expected", "run not as expected"


def plots_of(name: str, compared: Comparisons) -> Iterator[Plot]:
    """Yields the pass rates of a scenario's cells, then a plot per quantity, all named `name`-..."""
    yield Plot(
        f"{name}-passed", "Pass rate of each cell, in percent", _passed(compared), "Runs that pass"
    )
    for index, quantity in enumerate(compared.quantities):
        rows = ((row.cell.name, row.summary.mean) for row in quantity.rows)
        shown = "; ".join(f"{cell}: {DASH if mean is None else f'{mean:.4g}'}" for cell, mean in rows)
        summary = f"{quantity.heading}, mean of each cell: {shown}"
        yield Plot(f"{name}-{index}", summary, _strips(quantity), quantity.heading)


def height(cells: Sequence[Cell]) -> str:
    """Returns how high the plots of a scenario are, in the page's terms."""
    lines = max(1, *(len(cell.values) for cell in cells))
    return f"{5.5 + len(cells) * (1.3 + 0.9 * lines):.1f}rem"


def _passed(compared: Comparisons) -> Figure:
    cells = compared.cells
    rates = [100 * cell.good / len(cell.attempts) for cell in cells]
    intervals = [(100 * cell.interval[0], 100 * cell.interval[1]) for cell in cells]
    mean = means("pass rate with its 95 % interval", rates, intervals)
    asked = compared.verdict.attempts[0].case.scenario.pass_rate
    limits = [] if asked is None else [_limit("pass rate of all runs, at least", 100 * asked.min, "%")]
    shown = -ROOM * 100, 100 * (1 + ROOM)
    return strips([mean], [cell.name for cell in cells], "%", shown, limits)


def _strips(quantity: Compared) -> Figure:
    cells = [row.cell for row in quantity.rows]
    summaries = [row.summary for row in quantity.rows]
    averages, intervals = [s.mean for s in summaries], [s.interval for s in summaries]
    limits = list(_limits(quantity))
    runs = [_dots(quantity, good=good) for good in (True, False)]
    shown = [value for row in quantity.rows for value in row.values if math.isfinite(value)]
    shown += [end for interval in intervals if interval for end in interval]
    shown += [limit["x0"] for limit in limits]
    traces = [trace for trace in runs if trace["x"]]
    if any(mean is not None for mean in averages):
        traces.append(means("mean with its 95 % interval", averages, intervals))
    names = [cell.name for cell in cells]
    return strips(traces, names, quantity.unit, _around(shown), limits)


def _around(shown: Sequence[float]) -> Interval:
    low, high = min(shown, default=0.0), max(shown, default=1.0)
    room = ROOM * (high - low) or max(abs(high), 1.0) * ROOM
    return low - room, high + room


def _dots(quantity: Compared, *, good: bool) -> Trace:
    points = [
        (value, beside(index, number, len(row.values)), attempt.case.run.seed)
        for index, row in enumerate(quantity.rows)
        for number, (value, attempt) in enumerate(zip(row.values, row.cell.attempts, strict=True))
        if math.isfinite(value) and outcome_of(attempt).is_good == good
    ]
    name, *look = (AS_EXPECTED, METRIC, "circle") if good else (NOT_AS_EXPECTED, TRUTH, "x-thin-open")
    return dots(name, points, "seed %{customdata}: %{x}", *look)


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
