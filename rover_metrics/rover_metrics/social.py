"""Command: how a rover did among people, from logs of RoboTerrain's collector or of harness.run.

    python -m rover_metrics.social LOG... [--groups NAME...] [--page FILE.html]

Parses, calls, prints; the work is in rover_metrics.analysis.social. Needs no ROS.
"""

import argparse
import json
import sys
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any

from rover_metrics.errors import RoverMetricsError, begin_program, run_program
from rover_metrics.parser import OneLineParser, level, positive

if __name__ == "__main__":
    begin_program("social")

from rover_metrics.analysis import program
from rover_metrics.analysis.social.comparison import Group as Runs
from rover_metrics.analysis.social.comparison import differences, make_group
from rover_metrics.analysis.social.log import SocialLog, read_social_log
from rover_metrics.analysis.social.metrics import RISK_DISTANCE, WINDOW_GOALS
from rover_metrics.analysis.social.sheets import social_sheets
from rover_metrics.log.files import json_safe, write_whole
from rover_metrics.number import whole
from rover_metrics.sheet.render import csv_of


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns 0 if every log was read, 1 if any was skipped, 2 after a mistake."""
    return run_program("social", lambda: _run(_parser().parse_args(arguments)))


def _run(options: argparse.Namespace) -> int:
    logs, _, code = program.read_each("social", _files(options.logs), read_social_log)
    if not logs:
        return code
    groups = {
        name: make_group(name, members, options.window, options.risk_distance)
        for name, members in _grouped(logs, options.groups).items()
    }
    compared = differences(groups, options.confidence_level)
    sheets = list(social_sheets(groups, compared, options.window, options.risk_distance))
    if options.page is not None:
        from rover_metrics.analysis.social.page import render  # noqa: PLC0415 - matplotlib takes a second

        write_whole(options.page, render(groups, sheets))
    if options.csv is not None:
        write_whole(options.csv, csv_of(sheets))
    written = "" if options.page is None else f"page: {options.page}"
    program.hand_over(options.json, lambda: _as_json(groups, compared), sheets, written)
    return code


def _as_json(groups: dict[str, Runs], compared: Sequence[Any]) -> str:
    """All results as JSON."""
    values: dict[str, Any] = {"groups": {}, "differences": [asdict(each) for each in compared]}
    for name, group in groups.items():
        runs = [
            {"log": str(log.path), "findings": log.findings, **asdict(run)}
            for log, run in zip(group.logs, group.figures, strict=True)
        ]
        values["groups"][name] = {"runs": runs, "windows": group.windows.tolist()}
    return json.dumps(json_safe(values), indent=2)


def _files(named: Sequence[Path]) -> list[Path]:
    """The logs named, and those in the folders named and below; each once."""
    files: list[Path] = []
    for path in named:
        there = [*program.inside([path], "social_log*.csv")]
        there = [*program.inside([path], "*.csv")] if there == [path] else there
        if there == [path] and path.is_dir():
            raise RoverMetricsError(f"{path}: there is no log (*.csv) in this folder; name another")
        files += there
    return program.different("social", files)


def _grouped(logs: Sequence[SocialLog], wanted: Sequence[str]) -> dict[str, list[SocialLog]]:
    """Logs by group, in the order of the groups."""
    folders = Counter(home.name for home in {_folder(log.path): None for log in logs})
    for name, count in folders.items() if not wanted else ():
        if count > 1:
            mend = "tell them apart by --groups NAME=PATTERN"
            program.tell("social", f"{count} folders called {name} are one group; {mend}")
    groups: dict[str, list[SocialLog]] = {}
    for text in wanted or folders:
        name, _, pattern = text.partition("=")
        if not name or name in groups:
            raise RoverMetricsError(f"--groups '{text}': give each group a name of its own")
        groups[name] = [
            log
            for log in logs
            if (fnmatchcase(str(log.path), pattern) if pattern else _folder(log.path).name == name)
        ]
        if not groups[name]:
            raise RoverMetricsError(
                f"group '{name}' has no log; the folders of the logs are: {', '.join(folders)}; "
                "or name a group and the logs in it: NAME=PATTERN, as in nav2='*/nav2_*.csv'"
            )
    for log in logs:
        homes = [name for name, members in groups.items() if log in members]
        if len(homes) > 1:
            raise RoverMetricsError(
                f"{log.path} is in groups {' and '.join(homes)}; each log belongs to one"
            )
        if not homes:
            program.tell("social", f"{log.path} is in no group and left out")
    return groups


def _folder(path: Path) -> Path:
    """The folder by whose name a log is grouped: its own, or that above `social/`, where runs put it."""
    folder = path.resolve().parent
    return folder.parent if folder.name == "social" else folder


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m rover_metrics.social",
        description="Risk, speed and nearness of a rover among people; whether groups of runs differ.",
        epilog="Exit code: 0 if every log was read, 1 if any was skipped, 2 for wrong words or files.",
    )
    add = parser.add_argument
    about = "log (CSV) of RoboTerrain's collector or of harness.run, or a folder of them"
    add("logs", nargs="+", type=Path, metavar="LOG", help=about)
    about = (
        "the groups to compare, in this order, the first of each pair being the reference; a folder's "
        "name, or NAME=PATTERN of paths; default: each folder is one"
    )
    add("--groups", nargs="+", default=[], metavar="NAME", help=about)
    about = "goals of a window"
    add("--window", type=_goals, default=WINDOW_GOALS, metavar="N", help=about)
    about = "distance below which a second counts as risk"
    add("--risk-distance", type=positive, default=RISK_DISTANCE, metavar="M", help=about)
    about = "of the intervals, between 0 and 1"
    add("--confidence-level", type=level, default=0.95, metavar="P", help=about)
    add("--csv", type=Path, metavar="FILE", help="write the rows of the tables as CSV")
    program.add_documents(parser)
    return parser


def _goals(text: str) -> int:
    with suppress(ValueError):
        if whole(text) > 0:
            return whole(text)
    raise argparse.ArgumentTypeError(f"'{text}' is not valid; give a whole number from 1 up")


if __name__ == "__main__":
    sys.exit(main())
