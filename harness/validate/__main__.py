"""Command: drive standard manoeuvres and compare what the rovers do with what their sources say.

    python -m harness.validate --robot leo --seed 1
    python -m harness.validate --robot rover_zero4wd --realism A.csv B.csv

Parses, calls, prints; the work is in harness.validate.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.cli.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.validate")

from rich.console import Console

from harness.base.errors import UsageError
from harness.cli.plain import PlainConsole
from harness.robots import ROVERS, find_rover
from harness.validate.realism import compare, print_comparison
from harness.validate.suite import print_table, validate
from rover_metrics.errors import OneLineParser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 1 after a miss, 2 for bad arguments."""
    options = _parser().parse_args(arguments)
    return run_program("harness.validate", lambda: _validate(options, PlainConsole()))


def _validate(options: argparse.Namespace, console: Console) -> int:
    if options.seed < 0:
        raise UsageError(f"seed {options.seed} is not valid; give a whole number from 0 up")
    if options.realism and options.robot is None:
        raise UsageError("--realism needs --robot, the rover that the logs are of")
    misses = _realism(options, console) if options.realism else _suite(options, console)
    if misses:
        print(f"harness.validate: missed {'; '.join(misses)}", file=sys.stderr)
    return 1 if misses else 0


def _suite(options: argparse.Namespace, console: Console) -> Sequence[str]:
    rovers = ROVERS.values() if options.robot is None else [find_rover(options.robot)]
    misses = []
    for rover in rovers:
        with console.status(f"driving {rover.name}"):
            checks = validate(rover, options.seed)
        print_table(console, rover.name, checks)
        misses += [f"{rover.name}: {check.quantity}" for check in checks if not check.passed]
    return misses


def _realism(options: argparse.Namespace, console: Console) -> Sequence[str]:
    find_rover(options.robot)
    with console.status(f"driving {options.robot} for ten minutes"):
        comparison = compare(options.realism, options.robot, options.seed)
    print_comparison(console, comparison)
    return comparison.missed


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.validate",
        description="Drives standard manoeuvres and compares the rovers with their sources.",
    )
    about = f"{', '.join(ROVERS)}, or a folder (docs/robots.md); default: all that ship"
    parser.add_argument("--robot", metavar="NAME|FOLDER", help=about)
    parser.add_argument(
        "--seed", type=int, default=0, metavar="N", help="headings and the unevenness of the floor"
    )
    parser.add_argument(
        "--realism",
        nargs=2,
        type=Path,
        metavar=("A.csv", "B.csv"),
        help="compare a 10-minute run with two logs recorded of that rover instead",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
