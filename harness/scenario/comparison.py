"""The cells of a scenario's matrix side by side: what each quantity came to, and how cells differ.

A run is one observation. Its value is what the bound compares (`judge.value_of`); the statistics are
those of `python -m rover_metrics.analyze`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from harness.scenario.attempt import Attempt
from harness.scenario.bound import Bound
from harness.scenario.case import Case, cell_name
from harness.scenario.topic import COUNT, topic_quantity
from harness.scenario.verdict import CONFIDENCE, Verdict, outcome_of, wilson
from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.comparison import Comparison, compare, holm
from rover_metrics.analysis.statistics.summary import Interval, Summary, summarise_independent


@dataclass(frozen=True)
class Cell:
    """The runs that have the same values of the matrix.

    Attributes:
        values: Those, by name; none without a matrix.
        attempts: The runs, in the order of their seeds.
        good: How many are as they should be.
        interval: Of the share of these, by Wilson's method.
    """

    values: tuple[tuple[str, Any], ...]
    attempts: tuple[Attempt, ...]
    good: int
    interval: Interval

    @property
    def name(self) -> str:
        """Returns e.g. "leo, gravel"."""
        return cell_name(self.values) or "all runs"


@dataclass(frozen=True)
class Row:
    """A quantity in a cell.

    Attributes:
        cell: The cell.
        values: By run; NaN where there was none.
        summary: Of those that there are.
        difference: From the first cell; None in that one.
    """

    cell: Cell
    values: tuple[float, ...]
    summary: Summary
    difference: Comparison | None


@dataclass(frozen=True)
class Compared:
    """A quantity in all cells.

    Attributes:
        title: E.g. "truth.speed, mean of 5 to 10 s".
        bound: What it must keep.
        unit: Of its values.
        rows: One a cell.
    """

    title: str
    bound: Bound
    unit: str
    rows: tuple[Row, ...]

    @property
    def heading(self) -> str:
        """Returns the title of a quantity's column, with the unit."""
        return f"{self.title} [{self.unit}]" if self.unit else self.title


@dataclass(frozen=True)
class Comparisons:
    """A scenario, cell by cell.

    Attributes:
        verdict: What is said of it.
        cells: The first is what the others are compared with.
        quantities: One a bound.
    """

    verdict: Verdict
    cells: tuple[Cell, ...]
    quantities: tuple[Compared, ...]


def comparisons_of(verdict: Verdict) -> Comparisons:
    """Returns the cells of a scenario, and what each quantity came to in them."""
    cells = tuple(_cells(verdict.attempts))
    quantities = [
        _compared(title_of(name, bound), bound, index, cells)
        for index, (name, bound) in enumerate(verdict.attempts[0].case.scenario.bounds)
    ]
    return Comparisons(verdict, cells, tuple(_adjusted(quantities)))


def title_of(name: str, bound: Bound) -> str:
    """Returns what the values of a bound are called."""
    quantity = topic_quantity(name)
    if quantity is not None and quantity.what == COUNT:
        return f"{name}{_window(bound)}"
    words = {
        "end": "at the end",
        "mean": "mean",
        "p95": "95th percentile",
        "share": "share within limits",
    }
    if bound.over in words:
        what = words[bound.over]
    elif bound.min is not None and bound.max is not None:
        what = "nearest to a limit"
    else:
        what = "highest" if bound.min is None else "lowest"
    return f"{bound.label(name)}, {what}{_window(bound)}"


def _window(bound: Bound) -> str:
    return "" if bound.window is None else f", {bound.window[0]:g} to {bound.window[1]:g} s"


def _cells(attempts: Sequence[Attempt]) -> Iterator[Cell]:
    for values, group in groupby(attempts, key=lambda attempt: attempt.case.cell):
        some = tuple(group)
        good = sum(outcome_of(attempt).is_good for attempt in some)
        yield Cell(values, some, good, wilson(good, len(some)))


def _compared(title: str, bound: Bound, index: int, cells: Sequence[Cell]) -> Compared:
    values = [_values(cell, index) for cell in cells]
    units = (one.measured[index].unit for cell in cells for one in cell.attempts if one.measured)
    rows = [
        Row(
            cell,
            tuple(own.tolist()),
            summarise_independent(own[np.isfinite(own)], Kind.LEVEL, CONFIDENCE),
            _difference(title, (cells[0], cell), (values[0], own)) if cell is not cells[0] else None,
        )
        for cell, own in zip(cells, values, strict=True)
    ]
    return Compared(title, bound, next(units, ""), tuple(rows))


def _values(cell: Cell, index: int) -> Floats:
    measured = (one.measured[index].value if one.measured else None for one in cell.attempts)
    return np.array([math.nan if value is None else value for value in measured])


def _difference(title: str, cells: tuple[Cell, Cell], values: tuple[Floats, Floats]) -> Comparison:
    """Of the second from the first; run by run where both drove in the same worlds."""
    first, second = values
    if _pairs(*cells):
        both = np.isfinite(first) & np.isfinite(second)
        return compare(title, first[both], second[both], CONFIDENCE, paired=True)
    return compare(title, first[np.isfinite(first)], second[np.isfinite(second)], CONFIDENCE)


def _pairs(first: Cell, second: Cell) -> bool:
    def worlds(cell: Cell) -> list[tuple[Any, ...]]:
        return [_world(attempt.case) for attempt in cell.attempts]

    return worlds(first) == worlds(second)


def _world(case: Case) -> tuple[Any, ...]:
    return case.run.seed, case.run.world, case.run.rover.start


def _adjusted(quantities: Sequence[Compared]) -> Iterator[Compared]:
    """With p-values adjusted for all comparisons of the scenario."""
    differences = [row.difference for quantity in quantities for row in quantity.rows]
    adjusted = iter(holm([None if one is None else one.p for one in differences]))
    for quantity in quantities:
        rows = ((row, next(adjusted)) for row in quantity.rows)
        yield replace(
            quantity,
            rows=tuple(
                replace(row, difference=row.difference and replace(row.difference, p_holm=p))
                for row, p in rows
            ),
        )
