"""Command: drive the Course, verify a receipt of it, make the leader board.

    python -m harness.course run gap --track rocky --out results
    python -m harness.course verify results/gap.json

Parses, calls, prints; the work is in the other modules of harness.course.
"""

import argparse
import secrets
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.course")

from rich.console import Console

from harness.base.errors import UsageError
from harness.base.files import check_target, write_whole
from harness.base.interrupt import StopRequest
from harness.cli.console import counted
from harness.course.board import board_of, page_of, read_folder
from harness.course.drive import cases_of, check_origin, differences, drawn, drive_all
from harness.course.entry import BASELINES, LEARNED, find_entry
from harness.course.receipt import read_receipt, receipt_of, write_receipt
from harness.course.sheets import sheet_of
from harness.course.tracks import SEEDS, TRACKS, find_track
from harness.workers import add_options, workers_of
from rover_metrics.errors import OneLineParser
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal

OUT, PAGE = Path("course"), "board.html"
WORLDS = (
    "track barn: a folder of BARN's .world files (and path_N.npy) or of cylinders.csv (and paths.csv); "
    "default: the 50 worlds of its test, which ship"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    options = _parser().parse_args(arguments)
    return run_program("harness.course", lambda: _interruptible(options))


def _interruptible(options: argparse.Namespace) -> int:
    with StopRequest():
        code: int = options.do(options, PlainConsole())
        return code


def _run(options: argparse.Namespace, console: Console) -> int:
    entry = find_entry(options.entry)
    tracks = [find_track(name) for name in options.track or (["barn"] if options.worlds else TRACKS)]
    if options.seeds < 1 or (options.seeds > SEEDS and not (options.nonce or options.worlds)):
        raise UsageError(f"--seeds {options.seeds} is not valid; give 1 to {SEEDS}")
    cases = cases_of(tracks, entry, options.seeds, nonce=options.nonce, worlds=options.worlds)
    target = _target(options.out, entry.name)
    with (
        workers_of(options.backend, options.address, options.jobs) as workers,
        counted(console, f"driving {entry.name}") as show,
    ):
        results = drive_all(cases, entry, workers, show)
    receipt = receipt_of(entry, results, options.nonce, own_worlds=options.worlds is not None)
    write_receipt(receipt, target)
    console.print(*terminal((sheet_of(receipt),), console.width), sep="\n")
    console.print(f"score {receipt.score:.4f}; receipt: {target}", soft_wrap=True)
    return 0


def _target(folder: Path, name: str) -> Path:
    """The receipt's file, in a folder that is made if it is not there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"--out {folder} cannot be made: {error.strerror}; name another") from error
    return folder / f"{''.join(c if c.isalnum() or c in '-_' else '_' for c in name)}.json"


def _verify(options: argparse.Namespace, console: Console) -> int:
    receipt = read_receipt(options.receipt)
    entry = find_entry(options.entry or receipt.entry)
    check_origin(receipt, entry)
    seed = secrets.randbelow(10**6) if options.seed is None else options.seed
    cases = drawn(receipt, seed, options.worlds)
    with (
        workers_of(options.backend, options.address, options.jobs) as workers,
        counted(console, f"driving {len(cases)} episodes again") as show,
    ):
        again = drive_all(cases, entry, workers, show)
    found = differences(receipt, again)
    for line in found:
        console.print(line, soft_wrap=True)
    said = f"{len(found)} figures differ" if found else "every figure is the same"
    console.print(f"{len(cases)} episodes driven again (--seed {seed}): {said}", soft_wrap=True)
    return int(bool(found))


def _board(options: argparse.Namespace, console: Console) -> int:
    receipts = read_folder(options.folder)
    page = options.page or options.folder / PAGE
    check_target("--page", page)
    write_whole(page, page_of(receipts), "the page", UsageError)
    console.print(*terminal((board_of(receipts),), console.width), sep="\n")
    console.print(f"leader board: {page}", soft_wrap=True)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.course",
        description="Tracks, scores and receipts that every machine reproduces (docs/course.md).",
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
    run.set_defaults(do=_run)
    verify = commands.add_parser("verify", help="drive a random tenth of a receipt again")
    verify.add_argument("receipt", type=Path, metavar="RECEIPT", help="what `run` wrote")
    verify.add_argument("--entry", metavar="FOLDER", help="the entry, unless it is a baseline")
    verify.add_argument("--seed", type=int, metavar="N", help="of the choice (default: any)")
    verify.set_defaults(do=_verify)
    board = commands.add_parser("board", help="make a page of a folder of receipts")
    board.add_argument("folder", type=Path, metavar="FOLDER", help="where receipts are")
    about = f"where to write it (default: FOLDER/{PAGE})"
    board.add_argument("--page", type=Path, metavar="FILE", help=about)
    board.set_defaults(do=_board)
    for command in (run, verify):
        command.add_argument("--worlds", type=Path, metavar="FOLDER", help=WORLDS)
        add_options(command)
    return parser


if __name__ == "__main__":
    sys.exit(main())
