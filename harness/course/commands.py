"""What the commands of harness.course do; each takes its options and returns its exit code."""

import argparse
import secrets
from pathlib import Path

from rich.console import Console

from harness.base.errors import UsageError, how_many
from harness.base.files import PAGES, check_target, write_whole
from harness.base.workers import workers_of
from harness.cli.console import counted
from harness.cli.sheets import files_of, write_sheets
from harness.course.board import board_of, page_of, read_folder
from harness.course.drive import cases_of, check_origin, differences, drawn, drive_all
from harness.course.entry import find_entry
from harness.course.receipt import read_receipt, receipt_of, sheet_of, write_receipt
from harness.course.referee import ENDINGS
from harness.course.tracks import SEEDS, TRACKS, find_track
from rover_metrics.sheet.render import terminal

PAGE = "board.html"


def run(options: argparse.Namespace, console: Console) -> int:
    """Drives an entry and writes its receipt; returns 1 if an episode broke off."""
    entry = find_entry(options.entry)
    tracks = [find_track(name) for name in options.track or (["barn"] if options.worlds else TRACKS)]
    if options.seeds < 1 or (options.seeds > SEEDS and not (options.nonce or options.worlds)):
        raise UsageError(f"--seeds {options.seeds} is not valid; give 1 to {SEEDS}")
    cases = cases_of(tracks, entry, options.seeds, nonce=options.nonce, worlds=options.worlds)
    target, files = _target(options.out, entry.name, overwrite=options.overwrite), files_of(options)
    with (
        workers_of(options.backend, options.address, options.jobs) as workers,
        counted(console, f"driving {entry.name}") as show,
    ):
        results = drive_all(cases, entry, workers, show)
    receipt = receipt_of(entry, results, options.nonce, own_worlds=options.worlds is not None)
    write_receipt(receipt, target)
    write_sheets(files, f"Course: {entry.name}", [sheet_of(receipt)])
    console.print(*terminal((sheet_of(receipt),), console.width), sep="\n")
    broken = [one for ones in results.values() for one in ones if one.ending not in ENDINGS]
    if broken:
        first = f"the first, seed {broken[0].seed} of {broken[0].track}: {broken[0].ending}"
        console.print(f"{how_many(len(broken), 'episode')} broke off; {first}", soft_wrap=True)
    console.print(f"score {receipt.score:.4f}; receipt: {target}", soft_wrap=True)
    return int(bool(broken))


def _target(folder: Path, name: str, *, overwrite: bool) -> Path:
    """The receipt's file, in a folder that is made if it is not there."""
    file = folder / f"{''.join(c if c.isalnum() or c in '-_' else '_' for c in name)}.json"
    if file.exists() and not overwrite:
        raise UsageError(f"{file} exists already, not overwriting; name another --out or --overwrite")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise UsageError(f"--out {folder} cannot be made: {error.strerror}; name another") from error
    return file


def verify(options: argparse.Namespace, console: Console) -> int:
    """Drives a part of a receipt again; returns 1 if a figure differs."""
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
    lines = differences(receipt, again)
    for line in lines:
        console.print(line, soft_wrap=True)
    verdict = (
        f"{how_many(len(lines), 'figure')} {'differs' if len(lines) == 1 else 'differ'}"
        if lines
        else "every figure is the same"
    )
    episodes = how_many(len(cases), "episode")
    console.print(f"{episodes} driven again (--seed {seed}): {verdict}", soft_wrap=True)
    return int(bool(lines))


def board(options: argparse.Namespace, console: Console) -> int:
    """Makes a page of a folder of receipts."""
    receipts, files = read_folder(options.folder), files_of(options)
    page = files.pop("page", options.folder / PAGE)
    check_target("--page", page, *PAGES)
    write_whole(page, page_of(receipts), "the page", UsageError)
    write_sheets(files, "", [board_of(receipts)])
    console.print(*terminal((board_of(receipts),), console.width), sep="\n")
    console.print(f"leader board: {page}", soft_wrap=True)
    return 0
