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

from harness.scenario.bound import Bound
from harness.scenario.case import cell_name
from harness.scenario.topic import COUNT, topic_quantity
from harness.scenario.verdict import CONFIDENCE, Attempt, Verdict, outcome_of, wilson
from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.comparison import Comparison, compare, holm
from rover_metrics.analysis.statistics.summary import Interval, Summary, summarise_independent


@dataclass(frozen=True)
class Cell:
    """The runs that have the same values of the matrix.

    Attributes:
        values: Those, by name; none without a matrix.
        good: How many runs are as they should be; `interval` is Wilson's of their share.
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
    """A quantity in a cell: values by run, NaN where there was none, and how they differ.

    `difference` is from the first cell; None in that one.
    """

    cell: Cell
    values: tuple[float, ...]
    summary: Summary
    difference: Comparison | None


@dataclass(frozen=True)
class Compared:
    """A quantity in all cells, a row each; its title is e.g. "truth.speed, mean, 5 to 10 s"."""

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
    """A scenario, cell by cell; the first is what the others are compared with."""

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


_WORDS = {"end": "at the end", "mean": "mean", "p95": "95th percentile", "share": "share within limits"}


def title_of(name: str, bound: Bound) -> str:
    """Returns what the values of a bound are called."""
    quantity = topic_quantity(name)
    if quantity is not None and quantity.what == COUNT:
        return f"{name}{_window(bound)}"
    if bound.over in _WORDS:
        what = _WORDS[bound.over]
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
    runs = [[attempt.case.run for attempt in cell.attempts] for cell in cells]
    worlds, others = ([(run.seed, run.world, run.rover.start) for run in some] for some in runs)
    if worlds == others:
        both = np.isfinite(first) & np.isfinite(second)
        return compare(title, first[both], second[both], CONFIDENCE, paired=True)
    return compare(title, first[np.isfinite(first)], second[np.isfinite(second)], CONFIDENCE)


def _adjusted(quantities: Sequence[Compared]) -> Iterator[Compared]:
    """With p-values adjusted for all comparisons of the scenario."""
    differences = [row.difference for quantity in quantities for row in quantity.rows]
    adjusted = iter(holm([None if one is None else one.p for one in differences]))
    for quantity in quantities:
        rows = (
            replace(row, difference=row.difference and replace(row.difference, p_holm=p))
            for row, p in zip(quantity.rows, adjusted, strict=False)
        )
        yield replace(quantity, rows=tuple(rows))
