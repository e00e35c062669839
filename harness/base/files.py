"""Files: whether one can be written, before the run; whole or not at all; what is made of them."""

import os
import tempfile
from collections.abc import Callable, Iterable
from functools import lru_cache, wraps
from pathlib import Path
from typing import ParamSpec, TypeVar

from harness.base.errors import HarnessError, UsageError
from rover_metrics.log.files import whole_file

__all__ = ["BESIDE", "check_target", "made_of_files", "modified_ns", "whole_file", "write_whole"]

P = ParamSpec("P")
T = TypeVar("T")
Files = Iterable[Path | str]
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
        with whole_file(path) as part:
            part.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise failure(f"cannot write {name and f'{name} to '}{path}: {error.strerror}") from error


def check_target(flag: str, target: Path, suffix: str = "") -> None:
    """Finds out before a run whether a file can be written; UsageError if it cannot.

    Args:
        flag: Where the user named it.
        target: The file; it may exist.
        suffix: How its name must end; any name will do without one.
    """
    if suffix and target.suffix.lower() != suffix:
        raise UsageError(f"{flag} '{target}': name a file that ends in {suffix}")
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


def made_of_files(size: int) -> Callable[[Callable[P, tuple[T, Files]]], Callable[P, T]]:
    """Decorates what makes something of files, so that it is made anew only when one of them changes.

    Args:
        size: How many results are kept, by the arguments.

    Returns:
        A decorator of functions that return what they make, and every file that they have read.
    """

    def decorate(make: Callable[P, tuple[T, Files]]) -> Callable[P, T]:
        @lru_cache(maxsize=size)
        def kept(*args: P.args, **kwargs: P.kwargs) -> tuple[T, tuple[Path, ...], list[int]]:
            made, read = make(*args, **kwargs)
            files = tuple(map(Path, read))
            return made, files, [*map(modified_ns, files)]

        @wraps(make)
        def current(*args: P.args, **kwargs: P.kwargs) -> T:
            made, files, written = kept(*args, **kwargs)  # type: ignore[arg-type]  # all are hashable
            if written != [*map(modified_ns, files)]:
                kept.cache_clear()
                made, *_ = kept(*args, **kwargs)  # type: ignore[arg-type]
            return made

        return current

    return decorate


def modified_ns(path: Path) -> int:
    """Returns when a file was last written [ns]; 0 if there is none."""
    return path.stat().st_mtime_ns if path.exists() else 0
