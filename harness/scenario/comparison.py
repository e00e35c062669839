"""The cells of a scenario's matrix side by side: what each quantity came to, and how cells differ.

A run is one observation. Its value is what the bound compares (`judge.value_of`); the statistics are
those of `python -m rover_metrics.analyze`.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count, groupby
from typing import Any

import numpy as np

from harness.scenario.bound import Bound
from harness.scenario.case import cell_name
from harness.scenario.names import COUNT, heard_quantity
from harness.scenario.verdict import CONFIDENCE, Attempt, Runs, Verdict
from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.comparison import Comparison, compare, holm, smallest_p
from rover_metrics.analysis.statistics.summary import Summary, summarise_independent


@dataclass(frozen=True)
class Cell(Runs):
    """The runs that have the same values of the matrix: those, by name; none without a matrix."""

    values: tuple[tuple[str, Any], ...]

    @property
    def name(self) -> str:
        """Returns e.g. "leo, gravel"."""
        return cell_name(self.values) or "all runs"


@dataclass(frozen=True)
class Row:
    """A quantity in a cell: values by run, NaN where there was none, and how they differ.

    `difference` is from `reference`, the first cell, or with `compare:` the first with the same other
    values of the matrix; None in that one.
    """

    cell: Cell
    values: tuple[float, ...]
    summary: Summary
    difference: Comparison | None
    reference: Cell


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

    @property
    def differences(self) -> list[Comparison]:
        """Returns all comparisons that have been tested."""
        every = (row.difference for quantity in self.quantities for row in quantity.rows)
        return [each for each in every if each is not None and each.p is not None]

    @property
    def power(self) -> str:
        """Returns why no difference can be told with so few runs, whatever they show; "" if one can."""
        tested, alpha = self.differences, 1.0 - CONFIDENCE
        if not tested:
            return ""
        least, paired = min(each.smallest_p or 1.0 for each in tested), tested[0].paired
        if len(tested) * least <= alpha * (1.0 + 1e-9):
            return ""
        enough = next(n for n in count(2) if len(tested) * smallest_p(n, n, paired=paired) <= alpha)
        return (
            f"{tested[0].n[0]} seeds cannot give p (Holm) < {alpha:.2g} in {len(tested)} comparisons, "
            f"whatever they show: it takes {enough}."
        )


def comparisons_of(verdict: Verdict) -> Comparisons:
    """Returns the cells of a scenario, and what each quantity came to in them."""
    cells = tuple(_cells(verdict.attempts))
    quantities = [
        _compared(title_of(name, bound), bound, index, cells)
        for index, (name, bound) in enumerate(verdict.attempts[0].case.scenario.measured)
    ]
    return Comparisons(verdict, cells, tuple(_adjusted(quantities)))


_WORDS = {"end": "at the end", "mean": "mean", "p95": "95th percentile", "share": "share within limits"}


def title_of(name: str, bound: Bound) -> str:
    """Returns what the values of a bound are called."""
    quantity = heard_quantity(name)
    if quantity is not None and quantity.measure == COUNT:
        return f"{name}{_window(bound)}"
    if bound.over in _WORDS:
        measure = _WORDS[bound.over]
    elif bound.min is not None and bound.max is not None:
        measure = "nearest to a limit"
    else:
        measure = "highest" if bound.min is None else "lowest"
    return f"{bound.label(name)}, {measure}{_window(bound)}"


def _window(bound: Bound) -> str:
    return "" if bound.window is None else f", {bound.window[0]:g} to {bound.window[1]:g} s"


def _cells(attempts: Sequence[Attempt]) -> Iterator[Cell]:
    for values, group in groupby(attempts, key=lambda attempt: attempt.case.cell):
        yield Cell(tuple(group), values)


def _compared(title: str, bound: Bound, index: int, cells: Sequence[Cell]) -> Compared:
    values = [_values(cell, index) for cell in cells]
    own_name = cells[0].attempts[0].case.scenario.compare
    references = [_reference(cell, cells, own_name) for cell in cells]
    units = (one.measured[index].unit for cell in cells for one in cell.attempts if one.measured)
    rows = [
        Row(
            cell,
            tuple(own.tolist()),
            summarise_independent(own[np.isfinite(own)], Kind.LEVEL, CONFIDENCE),
            None if cells[at] is cell else _difference(title, (cells[at], cell), (values[at], own)),
            cells[at],
        )
        for cell, own, at in zip(cells, values, references, strict=True)
    ]
    return Compared(title, bound, next(units, ""), tuple(rows))


def _reference(cell: Cell, cells: Sequence[Cell], name: str) -> int:
    """The place of the cell that another one is compared with."""
    if not name:
        return 0
    others = [pair for pair in cell.values if pair[0] != name]
    return next(
        place
        for place, each in enumerate(cells)
        if [pair for pair in each.values if pair[0] != name] == others
    )


def _values(cell: Cell, index: int) -> Floats:
    measured = (one.measured[index].value if one.measured else None for one in cell.attempts)
    return np.array([math.nan if value is None else value for value in measured])


def _difference(title: str, cells: tuple[Cell, Cell], values: tuple[Floats, Floats]) -> Comparison:
    """The second cell's difference from the first; run by run where both drove in the same worlds.

    On another soil a world has the same hills and rocks.
    """
    first, second = values
    runs = [[attempt.case.run for attempt in cell.attempts] for cell in cells]
    worlds, others = (
        [(run.seed, run.world.but(soil=""), run.rover.start) for run in some] for some in runs
    )
    if worlds == others:
        both = np.isfinite(first) & np.isfinite(second)
        return compare(title, first[both], second[both], CONFIDENCE, paired=True)
    return compare(title, first[np.isfinite(first)], second[np.isfinite(second)], CONFIDENCE)


def _adjusted(quantities: Sequence[Compared]) -> Iterator[Compared]:
    """The quantities with p-values adjusted for all comparisons of the scenario."""
    differences = [row.difference for quantity in quantities for row in quantity.rows]
    adjusted = iter(holm([None if one is None else one.p for one in differences]))
    for quantity in quantities:
        rows = (
            replace(row, difference=row.difference and replace(row.difference, p_holm=p))
            for row, p in zip(quantity.rows, adjusted, strict=False)
        )
        yield replace(quantity, rows=tuple(rows))
