"""Command: run scenarios and say which of them pass.

    python -m harness.scenario scenarios/ --jobs 2 --junit out.xml

Parses, calls, prints; the work is in the other modules of harness.scenario.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.cli.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.scenario")

from rich.console import Console

from harness.cli.console import counted
from harness.errors import UsageError
from harness.files import check_target
from harness.interrupt import StopRequest
from harness.scenario.baseline import write_baselines
from harness.scenario.suite import Selected, find_files, plan, run_all
from harness.scenario.told import tell
from harness.scenario.verdict import exit_code, verdicts_of
from harness.tuning.backend import BACKENDS, backend_of
from rover_metrics.errors import OneLineParser

OUT = Path("scenario_runs")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.scenario", lambda: _interruptible(options))


def _interruptible(options: argparse.Namespace) -> int:
    with StopRequest():
        return _run(options, Console())


def _run(options: argparse.Namespace, console: Console) -> int:
    if options.junit is not None:
        check_target("--junit", options.junit)
    cases = plan(find_files(options.paths), _seeds(options), _selected(options.only))
    with (
        backend_of(options.backend, options.address, options.jobs) as backend,
        counted(console, "driving scenarios") as show,
    ):
        compare = not options.update_baseline
        attempts = run_all(cases, backend, options.out, show, compare=compare, resume=options.resume)
    verdicts = verdicts_of(attempts)
    tell(console, verdicts)
    if options.junit is not None:
        from harness.scenario.junit import write_junit  # noqa: PLC0415 - few ask for it

        write_junit(verdicts, options.junit)
    if options.update_baseline:
        for path in write_baselines((a.case, a.recorded) for a in attempts if a.recorded):
            console.print(f"written: {path}", soft_wrap=True, highlight=False)
    return exit_code(verdicts)


def _seeds(options: argparse.Namespace) -> Sequence[int] | None:
    if options.seed is not None:
        return [options.seed]
    if options.seeds is None:
        return None
    if options.seeds < 1:
        raise UsageError(f"--seeds {options.seeds} is not valid; give 1 or more")
    return range(options.seeds)


def _selected(pairs: Sequence[str]) -> Selected:
    for pair in pairs:
        if "=" not in pair:
            raise UsageError(f"--only {pair}: give NAME=VALUE of a matrix, e.g. --only robot=leo")
    return tuple((pair.partition("=")[0], pair.partition("=")[2]) for pair in pairs)


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
    parser.add_argument("--jobs", type=int, metavar="N", help="processes (default: one per CPU)")
    parser.add_argument(
        "--backend",
        default="local",
        metavar="NAME",
        help=f"who drives: {', '.join(BACKENDS)} (default: %(default)s)",
    )
    parser.add_argument("--address", metavar="URL", help="of the Ray or Dask cluster")
    parser.add_argument("--junit", type=Path, metavar="FILE", help="write the verdicts as JUnit XML")
    parser.add_argument(
        "--out",
        type=Path,
        default=OUT,
        metavar="DIR",
        help="gets log, manifest and page of each run that does not pass (default: %(default)s)",
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
