"""The files that a suite is asked for, and its tables on a terminal."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console, Group

from harness.base.files import write_whole
from harness.scenario.case import scenario_name
from harness.scenario.comparison import comparisons_of
from harness.scenario.junit import junit_of
from harness.scenario.page.page import render
from harness.scenario.tables import HOW, WIDE, csv_of, json_of, latex_of, runs_of, sheets
from harness.scenario.verdict import Verdict
from rover_metrics.sheet.render import terminal

TEXTS = {"csv": csv_of, "json": json_of, "runs": runs_of, "latex": latex_of}


def write_outputs(verdicts: Sequence[Verdict], files: Mapping[str, Path]) -> None:
    """Writes what is asked for by name, all but JUnit the same bytes each time; or HarnessError."""
    if "junit" in files:
        write_whole(files["junit"], junit_of(verdicts), "the JUnit XML")
    several = [comparisons_of(verdict) for verdict in verdicts] if files.keys() - {"junit"} else []
    if "page" in files:
        write_whole(files["page"], render(several, files["page"]), "the page")
    if "plot" in files:
        from harness.scenario.box_plot import box_plots  # noqa: PLC0415 - loads matplotlib

        box_plots(several, files["plot"])
    for name, text_of in TEXTS.items():
        if name in files:
            write_whole(files[name], text_of(several), "the numbers")


def print_tables(console: Console, verdicts: Sequence[Verdict]) -> None:
    """Prints the cells of every scenario that has several runs."""
    several = [comparisons_of(verdict) for verdict in verdicts if len(verdict.attempts) > 1]
    for compared in several:
        name = scenario_name(compared.verdict.path)
        named = [replace(sheet, title=f"{name}: {sheet.title}") for sheet in sheets(compared)]
        console.print(Group(*terminal(named, console.width, WIDE)))
    if several:
        console.print(HOW, style="dim")
