"""Command: fit the numbers of a rover's rover.yaml to a recording of the real one.

    python -m harness.fit drive.csv --robot husky --out my_husky
    python -m harness.fit bag/ --robot my_rover --out my_rover_fitted --topic commands=/teleop/cmd_vel

Parses, calls, prints; the work is in harness.fit.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.fit")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.interrupt import StopRequest
from harness.base.workers import add_options, workers_of
from harness.robots import REAL, ROVERS, RoverSpec, equipped, find_rover
from rover_metrics.errors import complain
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal

SERIES = "commands", "wheels", "imu", "poses", "currents", "torques", "power"
LONGEST = 180.0  # [s]


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code: 0, 2 for bad arguments or recordings."""
    options = _parser().parse_args(arguments)
    return run_program("harness.fit", lambda: _interruptible(options))


def _interruptible(options: argparse.Namespace) -> int:
    with StopRequest():
        return _fit(options, PlainConsole())


def _fit(options: argparse.Namespace, console: Console) -> int:
    topics = _topics(options.topic)
    if not options.seconds > 0.0:
        raise UsageError(f"--seconds {options.seconds:g} is not valid; give more than 0")
    with loading():
        from harness.cli.console import counted
        from harness.fit.folder import check_new, write_folder
        from harness.fit.outcome import fit
        from harness.fit.page import render, tables
        from harness.fit.reading import read

    check_new(options.out)
    rover, source = _rover(options.rover, options.surface), options.recording[0].name
    recording = read(options.recording, rover, topics).within(-1e9, options.seconds)
    if recording.sources:
        read_as = ", ".join(f"{name} {topic}" for name, topic in sorted(recording.sources.items()))
        console.print(f"{source}: {read_as}; --topic chooses others", soft_wrap=True)
    for problem in recording.problems:
        complain("harness.fit", problem)
    with (
        workers_of(options.backend, options.address, options.jobs) as workers,
        counted(console, f"driving {rover.name} as {source}") as show,
    ):
        outcome = fit(rover, recording, workers, show)
    page = render(outcome, source)
    write_folder(rover, outcome.estimates, options.out, source, options.surface, page)
    console.print(*terminal(tables(outcome), console.width), sep="\n")
    surface = f" --surface {options.surface}" if options.surface else ""
    console.print(f"written: {options.out} (rover.yaml, fit.html)", soft_wrap=True)
    console.print(
        f"next: python -m harness.run --robot {options.out} --actuators real{surface}", soft_wrap=True
    )
    return 0


def _rover(name: str, surface: str) -> RoverSpec:
    """The rover where the search begins; a surface that its folder lacks begins with its own tyres."""
    rover = find_rover(name)
    if rover.steers:
        raise UsageError(f"{rover.name} steers; what can be fitted turns by its sides' difference")
    return equipped(rover, REAL, surface if surface in rover.surfaces else "")


def _topics(given: Sequence[str]) -> dict[str, str]:
    pairs = dict(one.partition("=")[::2] for one in given)
    for series, topic in pairs.items():
        if series not in SERIES or not topic:
            raise UsageError(
                f"--topic '{series}={topic}' is not valid; give SERIES=TOPIC, of {', '.join(SERIES)}"
            )
    return pairs


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.fit",
        description="Fits the numbers of a rover's rover.yaml to a recording of the real one and writes "
        "them as a new folder, with a page that says how well each is known (docs/real_rovers.md).",
    )
    about = "a bag (folder, .mcap, .db3), or CSV files of one drive"
    parser.add_argument("recording", type=Path, nargs="+", metavar="BAG|CSV", help=about)
    about = f"where the search begins: {', '.join(ROVERS)}, or a folder (docs/robots.md)"
    parser.add_argument("--robot", dest="rover", required=True, metavar="NAME|FOLDER", help=about)
    parser.add_argument("--out", required=True, type=Path, metavar="FOLDER", help="the new folder")
    about = "write what is found of tyres and ground as this surface; default: as the rover's own tyres"
    parser.add_argument("--surface", default="", metavar="NAME", help=about)
    about = f"of a bag, where it should be another: SERIES=TOPIC, SERIES one of {', '.join(SERIES)}"
    about += "; repeatable; default: by type"
    parser.add_argument("--topic", action="append", default=[], metavar="SERIES=TOPIC", help=about)
    about = "of the recording, from its first command (default: %(default)g)"
    parser.add_argument("--seconds", type=float, default=LONGEST, metavar="S", help=about)
    add_options(parser)
    return parser


if __name__ == "__main__":
    sys.exit(main())
