"""The whole suite, and its results as a table: on the terminal, and between markers of a README."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Column, Table

from harness.base.errors import UsageError
from harness.robots import RoverSpec
from harness.robots.sections import OPEN, Expected
from harness.validate import climbing, driving, square, stability
from harness.validate.check import Check

BEGIN = "<!-- begin: python -m harness.validate --write -->"
END = "<!-- end: python -m harness.validate --write -->"
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


def validate(rover: RoverSpec, seed: int) -> list[Check]:
    """Drives every manoeuvre; the same seed gives the same figures.

    Of a rover whose rover.yaml expects nothing everything is measured, and nothing judged.
    """
    checks = [check for manoeuvres in SUITE for check in manoeuvres(rover, seed)]
    judged = rover.expected != Expected()
    return checks if judged else [replace(check, expected=OPEN) for check in checks]


def print_table(console: Console, title: str, checks: Sequence[Check], missed: str = MISS) -> None:
    """Prints the checks of one rover.

    Args:
        console: Where to.
        title: Of the table.
        checks: One a row.
        missed: What a check is called whose quantity lies outside its span.
    """
    headings = (Column(heading, overflow="fold") for heading in HEADINGS)
    table = Table(*headings, title=title, title_justify="left")
    for check in checks:
        table.add_row(*cells_of(check, missed), style=None if check.passed else "bold red")
    console.print(table)


def as_markdown(results: Mapping[str, Sequence[Check]]) -> str:
    """Returns the tables of all rovers, each under its name."""
    return "\n\n".join(f"### {robot}\n\n{_rows(checks)}" for robot, checks in results.items())


def write_between_markers(path: Path, text: str) -> None:
    """Replaces what stands between the markers of a file.

    Raises:
        UsageError: The file cannot be read or written, or does not have the markers.
    """
    try:
        before, rest = path.read_text(encoding="utf-8").split(BEGIN)
        after = rest.split(END)[1]
        path.write_text(f"{before}{BEGIN}\n\n{text}\n\n{END}{after}", encoding="utf-8")
    except (ValueError, IndexError) as error:
        raise UsageError(f"{path} must hold '{BEGIN}' and '{END}' once each") from error
    except OSError as error:
        raise UsageError(f"cannot rewrite {path}: {error.strerror}") from error


def _rows(checks: Sequence[Check]) -> str:
    head = [f"| {' | '.join(HEADINGS)} |", "|---" * len(HEADINGS) + "|"]
    cells = ([cell.replace("|", "\\|") for cell in cells_of(check)] for check in checks)
    return "\n".join([*head, *(f"| {' | '.join(row)} |" for row in cells)])


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
