"""What harness.scenario does: drives, says which scenarios pass, writes what is asked for."""

import argparse
import os
from collections.abc import Iterable, Sequence

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.files import PAGES, check_target
from harness.base.interrupt import StopRequest
from harness.base.workers import LOCAL, workers_of
from harness.cli.console import counted
from harness.cli.flags import from_flags
from harness.scenario.attempt import AttemptOptions
from harness.scenario.baseline import write_baselines
from harness.scenario.case import Selected, find_files, plan
from harness.scenario.github import tell_github
from harness.scenario.suite import run_all
from harness.scenario.terminal import print_verdicts
from harness.scenario.verdict import Verdict, exit_code, verdicts_of
from harness.spec.live import LiveOptions
from harness.view.live import load_page
from rover_metrics.sheet.console import PlainConsole

ENDS = {"plot": (".png", ".pdf", ".svg"), "page": PAGES}  # how the names of files may end


def run_scenarios(options: argparse.Namespace, files: Iterable[str]) -> int:
    """Drives what options name, prints and writes, also the `files` that some name; the exit code."""
    console = PlainConsole()
    targets = {name: getattr(options, name) for name in files if getattr(options, name) is not None}
    for name, target in targets.items():
        check_target(f"--{name}", target, *ENDS.get(name, ()))
    load_page(from_flags(LiveOptions, options))
    with StopRequest():
        verdicts = _driven(options, console)
        if targets or options.table:
            from harness.scenario.outputs import print_tables, write_outputs

            if options.table:
                print_tables(console, verdicts)
            write_outputs(verdicts, targets)
    return exit_code(verdicts)


def _driven(options: argparse.Namespace, console: Console) -> list[Verdict]:
    live = from_flags(LiveOptions, options)
    if live.live is not None and ((options.jobs or 1) != 1 or options.backend != LOCAL):
        raise UsageError("--live shows one run after the other: leave out --jobs and --backend")
    jobs = options.jobs if live.live is None else 1
    cases = plan(find_files(options.paths), _seeds(options), _selected(options.only))
    with (
        workers_of(options.backend, options.address, jobs) as workers,
        counted(console, "driving scenarios") as show,
    ):
        how = AttemptOptions(compare=not options.update_baseline, keep=options.keep, live=live)
        attempts = run_all(cases, workers, options.out, show, how, resume=options.resume)
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
