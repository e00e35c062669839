"""Command: the soak. Two simulated hours twice over, and listeners that are held up.

python -m benchmarks.soak [--quick] [--write]
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from rich.console import Console

from benchmarks.measuring import Table
from benchmarks.own_domain import own_domain
from benchmarks.readme import README, conditions, write_soak
from benchmarks.show import printable
from benchmarks.soak.outcome import COLUMNS, Outcome
from benchmarks.soak.plan import FULL, QUICK, Plan
from benchmarks.soak.scenarios import SCENARIOS, Reference
from harness.base.errors import HarnessError, RunFailed
from harness.base.interrupt import StopRequest
from rover_metrics.parser import OneLineParser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 1 if a promise was broken."""
    parser = _parser()
    options = parser.parse_args(arguments)
    if options.write and options.quick:
        parser.error("--write runs everything in full; leave out --quick")
    console = Console(width=None if sys.stdout.isatty() else 160)
    told = conditions()
    console.print(told, highlight=False)
    try:
        with StopRequest(), own_domain():  # else a signal would leave folders and processes behind
            outcomes = list(soak(QUICK if options.quick else FULL, console))
    except HarnessError as error:
        print(f"soak: {error}", file=sys.stderr)
        return error.exit_code
    table = Table(title=TITLE, columns=COLUMNS, rows=tuple(outcome.cells() for outcome in outcomes))
    console.print(printable(table))
    complaints = [complaint for outcome in outcomes for complaint in outcome.complaints]
    for complaint in complaints:
        print(f"soak: {complaint}", file=sys.stderr)
    if options.write:
        write_soak(told, table)
        console.print(f"written to {README}")
    return RunFailed.exit_code if complaints else 0


TITLE = "The soak: sensors break all the time, listeners are held up"


def soak(plan: Plan, console: Console) -> Iterator[Outcome]:
    """The outcome of each scenario."""
    with TemporaryDirectory(prefix="harness_soak_") as name:
        folder = Path(name)
        with console.status("the same drive without ROS"):
            reference = Reference(plan, _made(folder / "reference"))
        for scenario in SCENARIOS:
            with console.status(str(scenario.__doc__)):
                outcome = scenario(plan, reference, _made(folder / scenario.__name__))
            console.print("; ".join(outcome.complaints) or "well", highlight=False, end=": ")
            console.print(", ".join(outcome.cells()).replace("**", ""), highlight=False)
            yield outcome


def _made(folder: Path) -> Path:
    folder.mkdir()
    return folder


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m benchmarks.soak",
        description="Drives for hours with broken sensors and listeners that are held up; fails if a "
        "message or a row is lost, a byte of a log changes, or memory grows.",
    )
    parser.add_argument("--quick", action="store_true", help="minutes instead of hours")
    parser.add_argument("--write", action="store_true", help="the table into benchmarks/README.md, too")
    return parser


if __name__ == "__main__":
    sys.exit(main())
