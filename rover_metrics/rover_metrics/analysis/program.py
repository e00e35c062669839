"""What the commands analyze and social share: reading, JSON, printing."""

import argparse
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

from rich.console import Group

from rover_metrics.analysis.logs.header import Skipped, UnreadableLog
from rover_metrics.errors import printable
from rover_metrics.log.files import write_whole
from rover_metrics.sheet.console import PlainConsole
from rover_metrics.sheet.render import terminal
from rover_metrics.sheet.sheet import Sheet

PRINTED = Path()  # in place of a file: on the terminal

AnyLog = TypeVar("AnyLog")


def add_documents(parser: argparse.ArgumentParser) -> None:
    """Adds --page FILE.html, and --json [FILE.json], whose value `hand_over` takes."""
    about = "write a page with pictures and tables"
    parser.add_argument("--page", type=Path, metavar="FILE.html", help=about)
    about = "write everything as JSON; without a FILE.json, print that instead of the tables"
    parser.add_argument("--json", nargs="?", const=PRINTED, type=_json_file, metavar="FILE", help=about)


def _json_file(text: str) -> Path:
    if not text.endswith(".json"):
        raise argparse.ArgumentTypeError(f"'{text}' does not end in .json; name logs before this option")
    return Path(text)


def hand_over(
    target: Path | None, as_json: Callable[[], str], sheets: Iterable[Sheet], last: str = ""
) -> None:
    """Prints tables and writes JSON.

    Args:
        target: Of --json: a file, or PRINTED, with which nothing but the JSON is printed; None without.
        as_json: Gives the JSON.
        sheets: The tables.
        last: Line below them; "" for none.
    """
    if target == PRINTED:
        try:
            print(as_json(), flush=True)
        except BrokenPipeError:  # piped into head
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return
    if target is not None:
        write_whole(target, as_json() + "\n")
    console = PlainConsole()
    console.print(Group(*terminal(sheets, console.width)))
    if last:
        console.print(last, soft_wrap=True)


def read_each(
    program: str, paths: Sequence[Path], read: Callable[[Path], AnyLog]
) -> tuple[list[AnyLog], list[Skipped], int]:
    """Reads the logs that can be read, and says on stderr which cannot.

    Args:
        program: Who says so.
        paths: Of the logs.
        read: Reads one, or raises UnreadableLog.

    Returns:
        The logs, what was skipped, and the exit code: 2 if a file is missing, 1 for any other fault.
    """
    logs: list[AnyLog] = []
    skipped: list[Skipped] = []
    code = 0
    for path in paths:
        try:
            logs.append(read(path))
        except UnreadableLog as error:  # noqa: PERF203 - a file is read, which takes longer
            tell(program, f"skipped {path}: {error}")
            skipped.append(Skipped(str(path), str(error)))
            code = max(code, error.exit_code)
    return logs, skipped, code


def inside(paths: Iterable[Path], pattern: str, *, without: str = "") -> Iterator[Path]:
    """Yields the files of folders and of those below, and files themselves.

    Args:
        paths: Files, which need not fit the pattern, and folders; a folder without any file that fits is
            yielded itself, so that its reader says that it is no log.
        pattern: Of the names in folders, e.g. "*.csv".
        without: How names begin that are left out of folders; "" leaves none out.
    """
    for path in paths:
        there = sorted(path.rglob(pattern)) if path.is_dir() else []
        yield from [file for file in there if not (without and file.name.startswith(without))] or [path]


def different(program: str, paths: Iterable[Path]) -> list[Path]:
    """Returns each file once, and says on stderr which has further names."""
    first: dict[Path, Path] = {}
    for path in paths:
        if first.setdefault(path.resolve(), path) is not path:
            tell(program, f"{path} is named more than once and counts once")
    return list(first.values())


def tell(program: str, message: str) -> None:
    """Prints one line to stderr; a file name cannot make it two."""
    print(f"{program}: {printable(message)}", file=sys.stderr)
