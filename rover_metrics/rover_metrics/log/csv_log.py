"""The durable log: every row is in the file, whole, before the next one is computed."""

import csv
import errno
import io
import os
import re
from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager, suppress
from datetime import datetime
from itertools import count
from pathlib import Path
from typing import BinaryIO

from rover_metrics.core.columns import COLUMNS, Field, Row
from rover_metrics.errors import LogError
from rover_metrics.log.social_log import SocialRow

FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n")  # what spreadsheets take for the beginning of one
NUMBER = re.compile(r"-\d+\.\d+")  # with a fixed number of decimals, which makes it a text
STEM = "metrics_log"
_IN_THE_WAY = "a file stands where a folder should be; remove it or choose another folder"
_LOCKED = "make it writable for this user or choose another folder"
_MENDS = {
    errno.EEXIST: _IN_THE_WAY,
    errno.ENOTDIR: _IN_THE_WAY,
    errno.EACCES: _LOCKED,
    errno.EPERM: _LOCKED,
    errno.EROFS: "choose a folder on a writable file system",
    errno.ENOSPC: "free some disk space or choose another folder",
    errno.EDQUOT: "free some of your disk quota or choose another folder",
}


class CsvLog(AbstractContextManager["CsvLog"]):
    """One session's file metrics_log_YYYYMMDD_HHMMSS.csv, never one that exists already.

    Each row goes to the operating system in one unbuffered write, so rows survive the death of this
    process; with fsync they survive a power cut too. A file that is deleted while it is written, with
    its folder or alone, is put back with all its rows; one that is moved is followed. Lines end in
    CR LF, as in RoboTerrain's logs.

    Args:
        directory: Folder for the file; created if it does not exist.
        started: When the session started, for the name; None for a name without it.
        fsync: Whether a row is on the disk itself before `write` returns; may be changed at any time.
        columns: The header.
        stem: Begin of the name.

    Attributes:
        path: The file, absolute.

    Raises:
        LogError: The folder or the file cannot be created.
    """

    def __init__(
        self,
        directory: str | Path,
        started: datetime | None,
        *,
        fsync: bool = False,
        columns: Sequence[str] = COLUMNS,
        stem: str = STEM,
    ) -> None:
        directory = Path(directory).absolute()
        try:
            name = stem if started is None else f"{stem}_{started:%Y%m%d_%H%M%S}"
            self.path, self._file = _create(directory, name)
        except OSError as error:
            raise _log_error("cannot create a log", directory, error) from error
        self.fsync = fsync
        self.rows = 0
        self._size = 0  # bytes of whole lines
        try:
            self._write_line(columns)
        except LogError:
            self.close()
            with suppress(OSError):
                self.path.unlink()
            raise

    def __exit__(self, *_: object) -> None:
        self.close()

    def write(self, row: Row | SocialRow) -> None:
        """Appends a row, or raises a LogError; then the file holds no part of it, and goes on."""
        self._write_line(row.as_fields())
        self.rows += 1

    def close(self) -> None:
        """Closes the file, or raises a LogError; closing twice is fine."""
        try:
            self._file.close()
        except OSError as error:
            raise _log_error("cannot finish a log", self.path.parent, error) from error

    def _write_line(self, cells: Iterable[Field]) -> None:
        text = io.StringIO(newline="")
        csv.writer(text).writerow(map(harmless, cells))
        line = text.getvalue().encode()
        try:
            _write_all(self._file, line)
            if self.fsync:
                _sync(self._file, self.path.parent if self._size == 0 else None)
            if os.fstat(self._file.fileno()).st_nlink == 0:
                self._put_back()
        except (OSError, ValueError) as error:  # ValueError: closed
            # Cut the file back to its whole lines; if even that fails, the next line overwrites.
            with suppress(OSError, ValueError):
                self._file.seek(self._size)
                self._file.truncate()
            raise _log_error("cannot write a row", self.path.parent, error) from error
        self._size += len(line)

    def _put_back(self) -> None:
        """Copies the deleted file, which lives on while it is open, to where it was."""
        path, file = _create(self.path.parent, self.path.stem)
        try:
            self._file.seek(0)
            _write_all(file, self._file.read())
            if self.fsync:
                _sync(file, path.parent)
        except OSError:
            file.close()
            path.unlink()
            raise
        self._file.close()
        self.path, self._file = path, file


def _create(directory: Path, stem: str) -> tuple[Path, BinaryIO]:
    """Opens the first of stem.csv, stem_1.csv, ... that does not exist, in a folder that will."""
    directory.mkdir(parents=True, exist_ok=True)
    for number in count():
        path = directory / (f"{stem}_{number}.csv" if number else f"{stem}.csv")
        with suppress(FileExistsError):
            return path, path.open("x+b", buffering=0)
    raise AssertionError  # count() does not end


def _write_all(file: BinaryIO, data: bytes) -> None:
    """Writes everything; a raw write may take only a part, as on a disk that is nearly full."""
    while data:
        data = data[file.write(data) :]


def _sync(file: BinaryIO, folder: Path | None) -> None:
    """Waits until the disk has a file's content, and the folder's entry of a new file."""
    os.fsync(file.fileno())
    if folder is not None and hasattr(os, "O_DIRECTORY"):  # Windows opens no folder
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)


def _log_error(problem: str, directory: Path, error: Exception) -> LogError:
    number, reason = (error.errno, error.strerror) if isinstance(error, OSError) else (0, str(error))
    mend = _MENDS.get(number or 0, "choose another folder")
    return LogError(f"{problem} in {directory}: {reason}; {mend}")


def harmless(cell: Field) -> Field:
    """Returns a cell, an apostrophe before text that spreadsheets would run (OWASP, CSV injection)."""
    if not isinstance(cell, str) or not cell.startswith(FORMULA) or NUMBER.fullmatch(cell):
        return cell
    return f"'{cell}"
