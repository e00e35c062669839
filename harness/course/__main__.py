"""Command: drive the Course, verify a receipt of it, make the leader board.

    python -m harness.course run gap --track rocky --out results
    python -m harness.course verify results/gap.json

Parses; the work is in the other modules of harness.course.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, loading, run_program

if __name__ == "__main__":
    begin_program("harness.course")

from harness.base.interrupt import StopRequest
from harness.base.workers import add_options
from harness.cli.sheets import add_files
from harness.course.entry import BASELINES, LEARNED
from harness.course.tracks import SEEDS, TRACKS
from rover_metrics.parser import OneLineParser
from rover_metrics.sheet.console import PlainConsole

OUT = Path("course")
WORLDS = (
    "track barn: a folder of BARN's .world files (and path_N.npy) or of cylinders.csv (and paths.csv); "
    "default: the 50 worlds of its test, which ship"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.course", lambda: _command(options))


def _command(options: argparse.Namespace) -> int:
    with loading():
        from harness.course import commands
    with StopRequest():
        code: int = getattr(commands, options.do)(options, PlainConsole())
        return code


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.course",
        description="Tracks, scores, and receipts by which they are driven again (docs/course.md).",
    )
    commands = parser.add_subparsers(
        required=True, metavar="COMMAND", parser_class=OneLineParser, help="COMMAND --help tells more"
    )
    run = commands.add_parser("run", help="drive an entry and write its receipt")
    baselines = ", ".join((*BASELINES, LEARNED))
    run.add_argument("entry", metavar="ENTRY", help=f"{baselines}, or a folder with entry.yaml")
    tracks = f"only this one; repeatable: {', '.join(TRACKS)}"
    run.add_argument("--track", action="append", metavar="NAME", help=tracks)
    run.add_argument(
        "--seeds",
        type=int,
        default=SEEDS,
        metavar="N",
        help="the first N of each track (default: %(default)s)",
    )
    run.add_argument("--nonce", default="", metavar="TEXT", help="unseen seeds, of this and the entry")
    run.add_argument(
        "--out", type=Path, default=OUT, metavar="DIR", help="gets ENTRY.json (default: %(default)s)"
    )
    run.add_argument("--overwrite", action="store_true", help="replace a receipt that is there")
    add_files(run)
    run.set_defaults(do="run")
    verify = commands.add_parser("verify", help="drive a random tenth of a receipt again")
    verify.add_argument("receipt", type=Path, metavar="RECEIPT", help="what `run` wrote")
    verify.add_argument("--entry", metavar="FOLDER", help="the entry, unless it is a baseline")
    verify.add_argument("--seed", type=int, metavar="N", help="of the choice (default: any)")
    verify.set_defaults(do="verify")
    board = commands.add_parser("board", help="make a page of a folder of receipts")
    board.add_argument("folder", type=Path, metavar="FOLDER", help="where receipts are")
    about = "where to write it (default: FOLDER/board.html)"
    board.add_argument("--page", type=Path, metavar="FILE", help=about)
    add_files(board, ("csv", "json"))
    board.set_defaults(do="board")
    for command in (run, verify):
        command.add_argument("--worlds", type=Path, metavar="FOLDER", help=WORLDS)
        add_options(command)
    return parser


if __name__ == "__main__":
    sys.exit(main())
