"""Comparisons of scenarios as tables: texts for terminal and page, every number for CSV and JSON."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from harness.base.version import __version__
from harness.scenario.case import Cell as Values
from harness.scenario.case import cell_name, scenario_name
from harness.scenario.comparison import Cell, Compared, Comparisons, Row
from harness.scenario.spec import Matrix
from harness.scenario.verdict import Attempt, outcome_of, reasons_of
from rover_metrics.log.files import json_safe
from rover_metrics.sheet.render import csv_text, latex
from rover_metrics.sheet.sheet import Sheet, interval_text, number, probability

HOW = (
    "A run is one observation. Interval: Student's. The difference is that from the first cell, or from "
    "the first that is alike but for what is compared; "
    "g: Hedges' standardised difference; delta: Cliff's, -1 to 1; p: exact permutation or Mann-Whitney "
    "U, where both cells drove in the same worlds exact sign flips or Wilcoxon, run by run; "
    "Holm: adjusted for all comparisons of the scenario."
)
SPARE, WIDE = frozenset({"difference", "delta", "n"}), 100  # what terminals with fewer columns leave out
PASSED = "passed"


def sheets(compared: Comparisons) -> list[Sheet]:
    """Returns the tables of a scenario: how many runs pass in each cell, then each quantity."""
    name = compared.verdict.attempts[0].case.scenario.compare
    of_quantity = partial(_two_way, name=name) if name else _quantity
    passed = [_passed(compared)] if compared.verdict.attempts[0].case.scenario.expect else []
    tables = [*passed, *map(of_quantity, compared.quantities)]
    tables[-1] = replace(tables[-1], caption=compared.power)  # said once
    return tables


def _passed(compared: Comparisons) -> Sheet:
    rows = (
        {
            "cell": cell.name,
            PASSED: f"{cell.good} of {len(cell.attempts)}",
            "rate": f"{cell.good / len(cell.attempts):.0%}",
            "95 % interval (Wilson)": " to ".join(f"{limit:.0%}" for limit in cell.interval),
        }
        for cell in compared.cells
    )
    return Sheet.of(rows, "Runs that pass")


def _quantity(quantity: Compared) -> Sheet:
    """Returns what a quantity came to in each cell, and how it differs from the first one."""
    rows = (
        {
            "cell": row.cell.name,
            "runs": str(row.summary.n),
            "mean": number(row.summary.mean),
            "95 % interval": interval_text(row.summary.interval),
            "difference": number(getattr(row.difference, "difference", None)),
            "g": number(getattr(row.difference, "hedges_g", None)),
            "delta": number(getattr(row.difference, "cliffs_delta", None)),
            "p (Holm)": probability(getattr(row.difference, "p_holm", None)),
        }
        for row in quantity.rows
    )
    return Sheet.of(rows, quantity.heading, spare=SPARE)


def _two_way(quantity: Compared, name: str) -> Sheet:
    """Returns a quantity by what is compared, a row for each combination of the other values."""

    def split(cell: Cell) -> tuple[str, str]:
        own = tuple(pair for pair in cell.values if pair[0] == name)
        return cell_name(tuple(p for p in cell.values if p[0] != name)) or "all", cell_name(own)

    compared = [(row, row.difference) for row in quantity.rows if row.difference is not None]
    means = {row.cell.values: row.summary.mean for row in quantity.rows}
    others = {split(row.cell)[1] for row, _ in compared}
    rows = (
        {
            "within": split(row.cell)[0] + ("" if len(others) == 1 else f": {split(row.cell)[1]}"),
            split(row.reference)[1]: number(means[row.reference.values]),
            next(iter(others)) if len(others) == 1 else "other": number(row.summary.mean),
            "difference": number(difference.difference),
            "95 % interval": interval_text(difference.interval),
            "g": number(difference.hedges_g),
            "delta": number(difference.cliffs_delta),
            "p (Holm)": probability(difference.p_holm),
            "n": str(difference.n[1]),
        }
        for row, difference in compared
    )
    return Sheet.of(rows, quantity.heading, spare=SPARE)


def latex_of(several: Sequence[Comparisons]) -> str:
    """Returns the tables for LaTeX; each caption says seeds, runs and test."""
    texts = []
    for place, compared in enumerate(several):
        for index, sheet in enumerate(sheets(compared)):
            caption = f"{_design(compared)} {HOW} {sheet.caption}".strip()
            file = f"scenario_{place}_{index}"
            texts.append(latex(replace(sheet, caption=caption, file=file, spare=frozenset())))
    return "\n".join(texts)


def _design(compared: Comparisons) -> str:
    """What was driven: seeds, runs in each cell, tests."""
    attempts = compared.verdict.attempts
    seeds = sorted({attempt.case.run.seed for attempt in attempts})
    is_range = seeds == list(range(seeds[0], seeds[-1] + 1)) and len(seeds) > 2
    words = f"{seeds[0]} to {seeds[-1]}" if is_range else ", ".join(map(str, seeds))
    tests = " and ".join(sorted({each.test for each in compared.differences if each.test})) or "none"
    return f"Seeds {words}; n = {len(compared.cells[0].attempts)} runs in each cell; test: {tests}."


def runs_of(several: Sequence[Comparisons]) -> str:
    """Returns a CSV with a row per run: its cell, seed and outcome, and a column per quantity."""
    records = [
        {
            "scenario": scenario_name(compared.verdict.path),
            **_values(attempt.case.cell),
            "seed": attempt.case.run.seed,
            "outcome": outcome_of(attempt).value,
            "simulated_s": attempt.simulated_s,
            **{
                quantity.heading: one.value
                for quantity, one in zip(compared.quantities, attempt.measured, strict=False)
            },
            "log": next((str(path) for path in attempt.kept if path.suffix == ".csv"), None),
        }
        for compared in several
        for attempt in compared.verdict.attempts
    ]
    return csv_text(records)


def csv_of(several: Sequence[Comparisons]) -> str:
    """Returns every number as CSV, a row per cell and quantity; an empty cell is no number."""
    return csv_text([record for compared in several for record in _records(compared)])


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
