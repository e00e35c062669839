"""Command: run scenarios and say which of them pass.

    python -m harness.scenario scenarios/ --jobs 2 --junit out.xml

Parses, calls, prints; the work is in the other modules of harness.scenario.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.scenario")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.files import check_target
from harness.base.interrupt import StopRequest
from harness.cli.console import counted
from harness.cli.flags import add_flags, from_flags
from harness.scenario.case import Selected, find_files, plan
from harness.scenario.terminal import print_verdicts
from harness.scenario.verdict import Verdict, exit_code, verdicts_of
from harness.spec.live import LiveOptions
from harness.workers import add_options, workers_of
from rover_metrics.errors import OneLineParser
from rover_metrics.sheet.console import PlainConsole

OUT = Path("scenario_runs")
FILES = {
    "junit": "write the verdicts as JUnit XML",
    "page": "write a page: what failed, and cells side by side",
    "csv": "write every cell's numbers",
    "json": "write the same, and every run",
    "runs": "write a CSV with a row a run",
    "latex": "write the tables for LaTeX (booktabs)",
    "plot": "draw a box plot of each quantity: .png, .pdf or .svg",
}
FORMERLY = {"page": ("--html",)}  # names of options from before all commands called them the same


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.scenario", lambda: _run(options, PlainConsole()))


def _run(options: argparse.Namespace, console: Console) -> int:
    targets = {name: getattr(options, name) for name in FILES if getattr(options, name) is not None}
    for name, target in targets.items():
        check_target(f"--{name}", target)
    with StopRequest():
        verdicts = _driven(options, console)
        if targets or options.table:
            from harness.scenario.outputs import print_tables, write_outputs  # noqa: PLC0415 - a second

            if options.table:
                print_tables(console, verdicts)
            write_outputs(verdicts, targets)
    return exit_code(verdicts)


def _driven(options: argparse.Namespace, console: Console) -> list[Verdict]:
    from harness.scenario.baseline import write_baselines  # noqa: PLC0415 - not for --help
    from harness.scenario.github import tell_github  # noqa: PLC0415
    from harness.scenario.suite import run_all  # noqa: PLC0415

    live = from_flags(LiveOptions, options)
    if live.live is not None and (options.jobs or 1) != 1:
        raise UsageError("--live shows one run after the other: leave out --jobs")
    jobs = options.jobs if live.live is None else 1
    cases = plan(find_files(options.paths), _seeds(options), _selected(options.only))
    with (
        workers_of(options.backend, options.address, jobs) as workers,
        counted(console, "driving scenarios") as show,
    ):
        compare = not options.update_baseline
        how = {"compare": compare, "resume": options.resume, "keep": options.keep, "live": live}
        attempts = run_all(cases, workers, options.out, show, **how)
    verdicts = verdicts_of(attempts)
    print_verdicts(console, verdicts)
    tell_github(verdicts, os.environ)
    if options.update_baseline:
        for path in write_baselines((a.case, a.recorded) for a in attempts if a.recorded):
            console.print(f"written: {path}", soft_wrap=True)
    return verdicts


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
    return tuple((name, value) for name, _, value in (pair.partition("=") for pair in pairs))


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
        "--keep", action="store_true", help="keep log and manifest of runs that pass there too"
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
