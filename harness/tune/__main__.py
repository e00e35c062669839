"""Command: compute a rover's metric thresholds from drives whose truth is known; say how good they are.

    python -m harness.tune --robot leo --robot rover_zero4wd --episodes 64 --jobs 2 --out tuning/

Parses, calls, prints; the work is in harness.tune.
"""

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.tune")

from rich.console import Console

from harness.base.files import write_whole
from harness.base.interrupt import Interrupted, StopRequest
from harness.base.workers import add_options, workers_of
from harness.cli.sheets import add_files, files_of, write_sheets
from harness.robots import ROVERS, find_rover
from rover_metrics.errors import complain
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole

EPISODES, DURATION, OUT = 64, 90.0, Path("tuning")


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 1 where the data do not support a threshold."""
    options = _parser().parse_args(arguments)
    return run_program("harness.tune", lambda: _interruptible(options))


def _interruptible(options: argparse.Namespace) -> int:
    try:
        with StopRequest():
            return _tune(options, PlainConsole())
    except Interrupted as error:
        error.args = (f"{error}; the same command goes on with the episodes in {options.out}",)
        raise


def _tune(options: argparse.Namespace, console: Console) -> int:
    with loading():
        from harness.cli.console import counted
        from harness.tune.episodes.plan import plan
        from harness.tune.episodes.store import Store
        from harness.tune.episodes.sweep import sweep
        from harness.tune.output import REPORT, print_studies, sheet_of, write_results
        from harness.tune.scoring.study import study

    robots, files = options.robot or list(ROVERS), files_of(options)
    for robot in robots:
        find_rover(robot)
    planned = plan(robots, options.episodes, options.seed, options.duration, options.driver)
    with workers_of(options.backend, options.address, options.jobs) as workers:
        store = Store(options.out, planned)
        with counted(console, f"driving {options.duration:g} s episodes") as show:
            records = sweep(planned, store, workers, lambda done: show(done, len(planned)))
    studies = []
    with counted(console, "scoring the thresholds") as show:
        for done, robot in enumerate(robots):
            show(done, len(robots))
            studies.append(study(robot, records, options.seed))
    print_studies(console, studies)
    with console.status("drawing the page"):
        for path in write_results(options.out, studies, records, _command(robots, options)):
            console.print(f"written: {path}", soft_wrap=True)
    if "page" in files:
        write_whole(files.pop("page"), (options.out / REPORT).read_text(encoding="utf-8"), "the page")
    write_sheets(files, "Thresholds", list(map(sheet_of, studies)))
    unsupported = [(each.name, one) for each in studies for one in each.verdicts if one.lack is not None]
    for robot, verdict in unsupported:
        complain("harness.tune", f"{robot}: no value for {verdict.name}, {verdict.lack}")
    return 1 if unsupported else 0


def _command(robots: Sequence[str], options: argparse.Namespace) -> str:
    """What makes these files, without what does not change them."""
    named = " ".join(f"--robot {robot}" for robot in robots)
    driver = f" --driver {shlex.quote(options.driver)}" if options.driver else ""
    return (
        f"python -m harness.tune {named} --episodes {options.episodes} "
        f"--duration {options.duration:g} --seed {options.seed}{driver}"
    )


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.tune",
        description="Drives rovers into, past and far from hazards over all kinds of ground, scores the "
        "thresholds of metrics_node against the truth, and writes a parameter file per rover.",
        epilog="An interrupted sweep goes on where it was: give the same command again.",
    )
    add = parser.add_argument
    about = f"{', '.join(ROVERS)}, or a folder (docs/robots.md); repeatable; default: all that ship"
    add("--robot", action="append", metavar="NAME|FOLDER", help=about)
    about = "worlds; each robot drives in all"
    add("--episodes", type=int, default=EPISODES, metavar="N", help=about)
    about = "simulated seconds of each episode"
    add("--duration", type=float, default=DURATION, metavar="S", help=about)
    add("--seed", type=int, default=0, metavar="N", help="of the worlds and drives")
    about = "who drives where none is to meet hazards, e.g. policy:FILE.npz; default: roam and wander"
    add("--driver", default="", metavar="NAME", help=about)
    add_options(parser)
    add("--out", type=Path, default=OUT, metavar="DIR", help="folder for episodes and results")
    add_files(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
