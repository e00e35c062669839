"""Command: run scenarios and say which of them pass.

    python -m harness.scenario scenarios/ --jobs 2 --junit out.xml

Parses; the work is in the other modules of harness.scenario.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.scenario")

from harness.base.workers import add_options
from harness.cli.flags import add_flags
from harness.spec.live import LiveOptions
from rover_metrics.parser import OneLineParser

OUT = Path("scenario_runs")
FILES = {
    "junit": "write the verdicts as JUnit XML",
    "page": "write a page: what failed, and cells side by side",
    "csv": "write every cell's numbers",
    "json": "write the same, and every run",
    "runs": "write a CSV with a row per run",
    "latex": "write the tables for LaTeX (booktabs)",
    "plot": "draw a box plot of each quantity: .png, .pdf or .svg",
}
FORMERLY = {"page": ("--html",)}  # names of options from before all commands called them the same


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    with loading():
        from harness.scenario.command import run_scenarios
    return run_program("harness.scenario", lambda: run_scenarios(options, FILES))


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.scenario",
        description="Runs scenarios: drives with expectations (docs/scenarios.md). Exit code 0: all "
        "passed; 1: an expectation was not met; 2: something could not be run.",
    )
    parser.add_argument(
        "paths", nargs="+", type=Path, metavar="FILE|FOLDER", help="*.scenario.yaml, or folders of them"
    )
    seeds = parser.add_mutually_exclusive_group()
    seeds.add_argument(
        "--seeds", type=int, metavar="N", help="run each with seeds 0 to N-1, not with those of its file"
    )
    seeds.add_argument("--seed", type=int, metavar="N", help="run each with this seed alone")
    parser.add_argument(
        "--only",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="only runs with this value of their matrix; repeatable",
    )
    add_options(parser)
    add_flags(parser.add_argument_group("live"), LiveOptions)
    for name, about in FILES.items():
        flags = (f"--{name}", *FORMERLY.get(name, ()))
        parser.add_argument(*flags, dest=name, type=Path, metavar="FILE", help=about)
    parser.add_argument("--table", action="store_true", help="print cells side by side")
    parser.add_argument(
        "--out",
        type=Path,
        default=OUT,
        metavar="DIR",
        help="gets log, manifest and page of each run that does not pass (default: %(default)s)",
    )
    parser.add_argument(
        "--keep",
        action="store_true",
        help="keep log and manifest of runs that pass there too, until they pass without this",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="go on where the same suite was stopped, by what is in --out",
    )
    parser.add_argument(
        "--update-baseline", action="store_true", help="record the runs as what later ones must match"
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
