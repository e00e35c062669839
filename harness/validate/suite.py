"""The whole suite, and its results as a table: on the terminal and in Markdown."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from rich.console import Console
from rich.table import Column, Table

from harness.robots import RoverSpec
from harness.validate import climbing, driving, square, stability
from harness.validate.check import NOTHING_TOLD, Check
from rover_metrics.sheet.render import markdown
from rover_metrics.sheet.sheet import Sheet

HEADINGS = ("quantity", "expected", "measured", "verdict", "source of the expectation")

Manoeuvres = Callable[[RoverSpec, int], Iterator[Check]]
SUITE: tuple[Manoeuvres, ...] = (
    driving.rest_checks,
    climbing.passage_checks,
    climbing.rocker_checks,
    driving.checks,
    square.checks,
    climbing.checks,
    stability.checks,
)


def validate(rover: RoverSpec, seed: int) -> list[Check]:
    """Drives every manoeuvre; the same seed gives the same figures.

    Of a rover whose rover.yaml expects nothing everything is measured, and nothing judged.
    """
    checks = [check for manoeuvres in SUITE for check in manoeuvres(rover, seed)]
    return checks if rover.expected else [replace(check, expected=NOTHING_TOLD) for check in checks]


def print_table(console: Console, robot: str, checks: Sequence[Check]) -> None:
    """Prints the checks of one rover.

    Args:
        console: Where to.
        robot: Name of the rover, as the title.
        checks: One a row.
    """
    headings = (Column(heading, overflow="fold") for heading in HEADINGS)
    table = Table(*headings, title=robot, title_justify="left")
    for check in checks:
        table.add_row(*cells_of(check), style=None if check.passed else "bold red")
    console.print(table)


def as_markdown(results: Mapping[str, Sequence[Check]]) -> str:
    """Returns the tables of all rovers, each under its name."""
    tables = (Sheet(HEADINGS, tuple(map(cells_of, checks)), robot) for robot, checks in results.items())
    return "\n".join(f"### {sheet.title}\n\n{markdown(sheet)}" for sheet in tables)


def cells_of(check: Check) -> tuple[str, str, str, str, str]:
    """Returns quantity, expected, measured, verdict and source as text."""
    told = check.expected.tells
    return (
        check.quantity,
        f"{check.expected.describe(check.digits)} {check.unit}".rstrip() if told else "-",
        f"{check.measured:.{check.digits}f} {check.unit}".rstrip(),
        ("ok" if check.passed else "MISS") if told else "-",
        check.expected.source if told else "",
    )
