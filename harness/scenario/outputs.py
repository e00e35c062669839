"""The files that a suite is asked for, and its tables on a terminal."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console, Group

from harness.base.files import write_whole
from harness.scenario.case import scenario_name
from harness.scenario.comparison import comparisons_of
from harness.scenario.junit import write_junit
from harness.scenario.page.page import render
from harness.scenario.tables import HOW, WIDE, csv_of, json_of, sheets
from harness.scenario.verdict import Verdict
from rover_metrics.sheet.render import terminal


def write_outputs(
    verdicts: Sequence[Verdict],
    junit: Path | None = None,
    html: Path | None = None,
    csv: Path | None = None,
    json: Path | None = None,
) -> None:
    """Writes what is asked for, each file whole or not at all; all but JUnit the same bytes each time.

    Args:
        verdicts: Of the suite.
        junit: Gets a test case a run.
        html: Gets the page.
        csv: Gets the numbers of each cell.
        json: Gets these and every run.

    Raises:
        HarnessError: One cannot be written.
    """
    if junit is not None:
        write_junit(verdicts, junit)
    several = [comparisons_of(verdict) for verdict in verdicts] if html or csv or json else []
    if html is not None:
        write_whole(html, render(several, html), "the page")
    if csv is not None:
        write_whole(csv, csv_of(several), "the numbers")
    if json is not None:
        write_whole(json, json_of(several), "the numbers")


def print_tables(console: Console, verdicts: Sequence[Verdict]) -> None:
    """Prints the cells of every scenario that has several runs."""
    several = [comparisons_of(verdict) for verdict in verdicts if len(verdict.attempts) > 1]
    for compared in several:
        name = scenario_name(compared.verdict.path)
        named = [replace(sheet, title=f"{name}: {sheet.title}") for sheet in sheets(compared)]
        console.print(Group(*terminal(named, console.width, WIDE)), highlight=False)
    if several:
        console.print(HOW, style="dim", highlight=False)
