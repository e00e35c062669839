"""The whole suite, and its results as a table."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

from rich.console import Console
from rich.table import Column, Table

from harness.robots import RoverSpec
from harness.robots.sections import OPEN, Expected
from harness.validate import climbing, driving, square, stability
from harness.validate.check import Check
from rover_metrics.sheet.sheet import Sheet

MISS = "MISS"
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


def validate(
    rover: RoverSpec, seed: int, show: Callable[[int, int], None] = lambda _, __: None
) -> list[Check]:
    """Drives every manoeuvre; the same seed gives the same figures.

    A rover whose rover.yaml expects nothing is measured in everything, and not judged.

    Args:
        rover: What drives.
        seed: Of everything random.
        show: Called with how many are done, and of how many.
    """
    checks: list[Check] = []
    for done, manoeuvres in enumerate(SUITE):
        show(done, len(SUITE))
        checks += manoeuvres(rover, seed)
    judged = rover.expected != Expected()
    return checks if judged else [replace(check, expected=OPEN) for check in checks]


def print_table(console: Console, title: str, checks: Sequence[Check], missed: str = MISS) -> None:
    """Prints the checks of one rover.

    Args:
        console: Where to.
        title: Of the table.
        checks: One per row.
        missed: What a check is called whose quantity lies outside its span.
    """
    headings = (Column(heading, overflow="fold") for heading in HEADINGS)
    table = Table(*headings, title=title, title_justify="left")
    for check in checks:
        table.add_row(*cells_of(check, missed), style=None if check.passed else "bold red")
    console.print(table)


def sheet_of(title: str, checks: Sequence[Check], missed: str = MISS) -> Sheet:
    """Returns checks as a table.

    Args:
        title: Of the table.
        checks: A row each.
        missed: What stands beside a check that was not passed.
    """
    return Sheet(HEADINGS, tuple(cells_of(check, missed) for check in checks), title)


def cells_of(check: Check, missed: str = MISS) -> tuple[str, str, str, str, str]:
    """Returns quantity, expected, measured, verdict and source of a check as text."""
    judged = not check.expected.is_open
    return (
        check.quantity,
        f"{check.expected.describe(check.digits)} {check.unit}".rstrip() if judged else "-",
        f"{check.measured:.{check.digits}f} {check.unit}".rstrip(),
        ("ok" if check.passed else missed) if judged else "-",
        check.expected.source if judged else "",
    )
