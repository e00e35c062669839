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

from harness.base.errors import UsageError
from harness.base.files import check_target
from harness.base.interrupt import StopRequest
from harness.cli.console import counted
from harness.scenario.baseline import write_baselines
from harness.scenario.case import Selected, find_files, plan
from harness.scenario.suite import run_all
from harness.scenario.terminal import print_verdicts
from harness.scenario.verdict import Verdict, exit_code, verdicts_of
from harness.workers import add_options, workers_of
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
    for flag, target in _targets(options).items():
        check_target(flag, target)
    cases = plan(find_files(options.paths), _seeds(options), _selected(options.only))
    with (
        workers_of(options.backend, options.address, options.jobs) as workers,
        counted(console, "driving scenarios") as show,
    ):
        compare = not options.update_baseline
        attempts = run_all(cases, workers, options.out, show, compare=compare, resume=options.resume)
    verdicts = verdicts_of(attempts)
    print_verdicts(console, verdicts)
    _write(options, console, verdicts)
    if options.update_baseline:
        for path in write_baselines((a.case, a.recorded) for a in attempts if a.recorded):
            console.print(f"written: {path}", soft_wrap=True, highlight=False)
    return exit_code(verdicts)


def _targets(options: argparse.Namespace) -> dict[str, Path]:
    files = {f"--{name}": getattr(options, name) for name in ("junit", "html", "csv", "json")}
    return {flag: path for flag, path in files.items() if path is not None}


def _write(options: argparse.Namespace, console: Console, verdicts: Sequence[Verdict]) -> None:
    if not _targets(options) and not options.table:
        return
    from harness.scenario.outputs import print_tables, write_outputs  # noqa: PLC0415 - a second at start

    if options.table:
        print_tables(console, verdicts)
    write_outputs(verdicts, options.junit, options.html, options.csv, options.json)


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
    add_options(parser)
    _add_files(parser)
    return parser


def _add_files(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--junit", type=Path, metavar="FILE", help="write the verdicts as JUnit XML")
    parser.add_argument(
        "--html", type=Path, metavar="FILE", help="write a page: what failed, and cells side by side"
    )
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write every cell's numbers")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write the same, and every run")
    parser.add_argument("--table", action="store_true", help="print cells side by side")
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


if __name__ == "__main__":
    sys.exit(main())
