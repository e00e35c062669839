"""Command: run scenarios and say which of them pass.

    python -m harness.scenario scenarios/ --jobs 2 --junit out.xml

Parses, calls, prints; the work is in the other modules of harness.scenario.
"""

import argparse
import signal
import sys
from collections.abc import Sequence
from pathlib import Path

if __name__ == "__main__":  # what follows takes a second to load; Ctrl-C must not show where it was
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from rich.console import Console

from harness.errors import HarnessError, UsageError
from harness.interrupt import StopRequest
from harness.scenario.suite import Selected, find_files, plan, run_all
from harness.scenario.told import tell, told_progress
from harness.scenario.verdict import exit_code, verdicts_of
from harness.tuning.backend import BACKENDS, backend_of
from rover_metrics.errors import OneLineParser

OUT = Path("scenario_runs")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    console = Console()
    try:
        with StopRequest():
            return _run(options, console)
    except HarnessError as error:
        print(f"harness.scenario: {error}", file=sys.stderr)
        return error.exit_code


def _run(options: argparse.Namespace, console: Console) -> int:
    seeds = None if options.seeds is None else list(range(options.seeds))
    if options.seed is not None:
        seeds = [options.seed]
    cases = plan(find_files(options.paths), seeds, _selected(options.only))
    with (
        backend_of(options.backend, options.address, options.jobs) as backend,
        told_progress(console, len(cases)) as show,
    ):
        attempts = run_all(cases, backend, options.out, show)
    verdicts = verdicts_of(attempts)
    tell(console, verdicts)
    return exit_code(verdicts)


def _selected(pairs: Sequence[str]) -> Selected:
    for pair in pairs:
        if "=" not in pair:
            raise UsageError(f"--only {pair}: give NAME=VALUE of a matrix, e.g. --only robot=leo")
    return tuple((pair.partition("=")[0], pair.partition("=")[2]) for pair in pairs)


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.scenario",
        description="Runs scenarios: drives with expectations. Exit code 0: all passed; 1: an "
        "expectation was not met; 2: something could not be run.",
    )
    parser.add_argument("paths", nargs="+", type=Path, metavar="FILE|FOLDER", help="*.scenario.yaml")
    parser.add_argument("--seeds", type=int, metavar="N", help="run each with seeds 0 to N-1")
    parser.add_argument("--seed", type=int, metavar="N", help="run each with this seed alone")
    parser.add_argument(
        "--only", action="append", default=[], metavar="NAME=VALUE", help="of a matrix; repeatable"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="processes; by default one per CPU")
    parser.add_argument("--backend", default="local", metavar="NAME", help=f"{', '.join(BACKENDS)}")
    parser.add_argument("--address", metavar="URL", help="of the Ray or Dask cluster")
    parser.add_argument("--out", type=Path, default=OUT, metavar="DIR", help="what failed runs leave")
    return parser


if __name__ == "__main__":
    sys.exit(main())
