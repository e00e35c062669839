"""Comparisons of scenarios as tables: texts for terminal and page, every number for CSV and JSON."""

import csv
import json
from collections.abc import Iterator, Sequence
from io import StringIO
from itertools import compress
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.table import Column, Table
from rich.text import Text

from harness import __version__
from harness.scenario.attempt import Attempt
from harness.scenario.case import Cell as Values
from harness.scenario.case import scenario_name
from harness.scenario.comparison import Cell, Compared, Comparisons, Row
from harness.scenario.spec import Matrix
from harness.scenario.verdict import outcome_of, reasons_of
from rover_metrics.analysis.tables.sheets import NONE, interval_text, number, probability
from rover_metrics.log.csv_log import harmless
from rover_metrics.log.files import json_safe

Texts = list[tuple[str, ...]]  # the head, then rows that their first cell names

HEAD = ("cell", "runs", "mean", "95 % interval", "difference", "g", "delta", "p (Holm)")
HOW = (
    "A run is one observation. Interval: Student's. The difference is that from the first cell; "
    "g: Hedges' standardised difference; delta: Cliff's, -1 to 1; p: exact permutation or Mann-Whitney "
    "U, where both cells drove in the same worlds exact sign flips or Wilcoxon, run by run; "
    "Holm: adjusted for all comparisons of the scenario."
)
SPARE, WIDE = ("difference", "delta"), 100  # what terminals with fewer columns leave out
PASSED = "passed"


def passed_texts(compared: Comparisons) -> Texts:
    """Returns how many runs of each cell are as they should be."""
    rows = (
        (
            cell.name,
            f"{cell.good} of {len(cell.attempts)}",
            f"{cell.good / len(cell.attempts):.0%}",
            " to ".join(f"{limit:.0%}" for limit in cell.interval),
        )
        for cell in compared.cells
    )
    return [("cell", PASSED, "rate", "95 % interval (Wilson)"), *rows]


def quantity_texts(quantity: Compared) -> Texts:
    """Returns what a quantity came to in each cell, and how it differs from the first one."""
    return [HEAD, *(_texts(row) for row in quantity.rows)]


def _texts(row: Row) -> tuple[str, ...]:
    summary, difference = row.summary, row.difference
    own = (row.cell.name, str(summary.n), number(summary.mean), interval_text(summary.interval))
    if difference is None:
        return (*own, *(NONE,) * 4)
    return (
        *own,
        number(difference.difference),
        number(difference.hedges_g),
        number(difference.cliffs_delta),
        probability(difference.p_holm),
    )


def printable(compared: Comparisons, width: int) -> Iterator[Table]:
    """Yields the tables of a scenario for a terminal of so many columns; a narrow one is shown less."""
    name = scenario_name(compared.verdict.path)
    yield _table(f"{name}: {PASSED}", passed_texts(compared))
    for quantity in compared.quantities:
        texts = quantity_texts(quantity)
        if width < WIDE:
            shown = [head not in SPARE for head in HEAD]
            texts = [tuple(compress(row, shown)) for row in texts]
        yield _table(f"{name}: {quantity.heading}", texts)


def _table(title: str, texts: Texts) -> Table:
    columns = (Column(head, justify="right", no_wrap=True) for head in texts[0][1:])
    table = Table(texts[0][0], *columns, title=Text(title), title_justify="left", box=SIMPLE_HEAD)
    for row in texts[1:]:
        table.add_row(*map(Text, row))
    return table


def csv_of(several: Sequence[Comparisons]) -> str:
    """Returns every number as CSV, a row a cell and quantity; an empty cell is no number."""
    records = [record for compared in several for record in _records(compared)]
    text = StringIO()
    writer = csv.DictWriter(text, list(records[-1]))
    writer.writeheader()
    writer.writerows({name: harmless(cell) for name, cell in record.items()} for record in records)
    return text.getvalue()


def json_of(several: Sequence[Comparisons]) -> str:
    """Returns every number and every run as JSON; null is no number."""
    content = {"version": __version__, "scenarios": [_scenario(compared) for compared in several]}
    return json.dumps(json_safe(content), indent=1, allow_nan=False, ensure_ascii=False) + "\n"


def _records(compared: Comparisons) -> Iterator[dict[str, Any]]:
    path = compared.verdict.path
    scenario = {"scenario": scenario_name(path), "file": str(path)}
    for cell in compared.cells:
        low, high = cell.interval
        yield {
            **scenario,
            **_values(cell.values),
            "quantity": PASSED,
            "unit": "",
            "n": len(cell.attempts),
            "mean": cell.good / len(cell.attempts),
            "mean_low": low,
            "mean_high": high,
        }
    for quantity in compared.quantities:
        for row in quantity.rows:
            about = {"quantity": quantity.title, "unit": quantity.unit}
            yield scenario | _values(row.cell.values) | about | _numbers(quantity, row)


def _numbers(quantity: Compared, row: Row) -> dict[str, Any]:
    summary, difference, bound = row.summary, row.difference, quantity.bound
    low, high = summary.interval or (None, None)
    numbers: dict[str, Any] = {"n": summary.n, "mean": summary.mean, "mean_low": low, "mean_high": high}
    numbers |= {name: getattr(summary, name) for name in ("sd", "median", "minimum", "maximum")}
    numbers |= {"limit_min": bound.min, "limit_max": bound.max}
    low, high = (difference and difference.interval) or (None, None)
    own = ("difference", "hedges_g", "cliffs_delta", "test", "paired", "p", "p_holm")
    compared = {name: getattr(difference, name) if difference else None for name in own}
    return numbers | compared | {"difference_low": low, "difference_high": high}


def _values(values: Values) -> dict[str, Any]:
    """The values of a cell by every name that a matrix can have."""
    return dict.fromkeys(Matrix.model_fields) | dict(values)


def _scenario(compared: Comparisons) -> dict[str, Any]:
    verdict = compared.verdict
    return {
        "scenario": scenario_name(verdict.path),
        "file": str(verdict.path),
        "about": verdict.attempts[0].case.scenario.about,
        "outcome": verdict.outcome.value,
        "pass_rate": verdict.rate,
        "interval": verdict.interval,
        "cells": [_cell(compared, index, cell) for index, cell in enumerate(compared.cells)],
        "runs": [_run(compared, attempt) for attempt in verdict.attempts],
    }


def _cell(compared: Comparisons, index: int, cell: Cell) -> dict[str, Any]:
    numbers = {each.title: _numbers(each, each.rows[index]) for each in compared.quantities}
    return {
        **dict(cell.values),
        PASSED: cell.good,
        "runs": len(cell.attempts),
        "interval": cell.interval,
        "quantities": numbers,
    }


def _run(compared: Comparisons, attempt: Attempt) -> dict[str, Any]:
    titles = [quantity.title for quantity in compared.quantities]
    return {
        "run": attempt.case.name,
        **dict(attempt.case.cell),
        "seed": attempt.case.run.seed,
        "outcome": outcome_of(attempt).value,
        "reasons": reasons_of(attempt),
        "again": attempt.case.command,
        "model_hash": attempt.model_hash,
        "terrain_hash": attempt.terrain_hash,
        "measured": dict(zip(titles, (one.value for one in attempt.measured), strict=False)),
        "page": str(attempt.kept[0]) if attempt.kept else None,
    }
