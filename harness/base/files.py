"""Files that are written: whether one can be, found out before the run; whole or not at all."""

import os
import tempfile
from pathlib import Path

from harness.base.errors import HarnessError, UsageError
from rover_metrics.log import files
from rover_metrics.log.files import whole_file

__all__ = ["BESIDE", "PAGES", "check_target", "whole_file", "write_whole"]

PAGES = (".html", ".htm", "")  # how the name of a page may end: none is made in another format
BESIDE = Path()  # in place of a file: beside the log of a run, under its name


def write_whole(
    path: Path, text: str, name: str = "", failure: type[HarnessError] = HarnessError
) -> None:
    """Writes a text as UTF-8; the file is there whole or not at all.

    Args:
        path: The file; it may exist.
        text: With the ends of its lines as they shall be.
        name: The text, for the message.
        failure: What is raised if it cannot be written.
    """
    try:
        files.write_whole(path, text)
    except OSError as error:
        raise failure(f"cannot write {name and f'{name} to '}{path}: {error.strerror}") from error


def check_target(flag: str, target: Path, *suffixes: str) -> None:
    """Finds out before a run whether a file can be written; UsageError if it cannot.

    Args:
        flag: Where the user named it.
        target: The file; it may exist.
        suffixes: How its name may end; any name will do without one.
    """
    if suffixes and target.suffix.lower() not in suffixes:
        ends = ", ".join(filter(None, suffixes))
        raise UsageError(f"{flag} '{target}': name a file that ends in {ends}")
    try:
        if target.is_dir():
            raise UsageError(f"{flag} {target} is a folder; name a file")
        if target.exists() and not target.is_file():  # a device or a pipe, which is written into
            if not os.access(target, os.W_OK):
                raise UsageError(f"{flag} {target} cannot be written; choose another place")
            return
        if not target.parent.is_dir():
            raise UsageError(f"{flag} {target}: there is no folder {target.parent}; create it first")
        with tempfile.TemporaryFile(dir=target.parent):
            pass  # os.access would not do: to root it says yes even in /proc
    except OSError as error:
        message = f"{flag} {target} cannot be written: {error.strerror}; choose another place"
        raise UsageError(message) from error
