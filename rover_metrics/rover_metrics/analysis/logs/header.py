"""The first line of a log, and what is wrong with a file that cannot be a log."""

import csv
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from rover_metrics.analysis.metric import METRIC_COLUMNS, STAMP
from rover_metrics.errors import RoverMetricsError, reason_of
from rover_metrics.log.files import packer_of

_LONGEST_HEADER = 1 << 16  # bytes
_MOST_SHOWN = 60  # characters
_SEPARATORS = (";", "\t")  # of cells, where a spreadsheet or another program wrote the file anew


class UnreadableLog(RoverMetricsError):
    """A file that is no metrics log; the message says why, without the path."""

    exit_code = 1


class MissingLog(UnreadableLog):
    """A file that is not there."""

    exit_code = 2


@dataclass(frozen=True)
class Skipped:
    """A file that could not be analysed, and why."""

    path: str
    reason: str


def read_header(path: Path) -> list[str]:
    """Returns the column names of a log without surrounding spaces, in the order of the file.

    Raises:
        UnreadableLog: There is no such file, or it does not begin like a metrics log.
    """
    text, has_rows = first_line(path)
    if not text.strip():
        problem = "first line is not a header but blank" if has_rows else "file is empty"
        raise UnreadableLog(f"the {problem}")
    names = [name.strip() for name in next(csv.reader([text], delimiter=separator_of(text)))]
    _check_names(names, text)
    if not has_rows:
        raise UnreadableLog("there is a header but no row")
    return names


def separator_of(text: str) -> str:
    """Returns what stands between the cells of a file, by its first line."""
    return next((each for each in _SEPARATORS if each in text and "," not in text), ",")


def comma_in_cells(rows: Iterable[bytes], separator: str) -> str:
    """Returns what a comma within a cell is to become: a decimal point, unless numbers have points."""
    end = f' *"? *(?:{separator}|[\r\n]|$)'
    number = re.compile(rf'(?:^|{separator}) *"? *[-+]?[\d,]*\.\d+(?:[eE][-+]?\d+)?{end}'.encode())
    return ";" if any(map(number.search, rows)) else "."


def as_logged(line: str, separator: str, comma: str) -> str:
    """Returns a line with commas between its cells, without quotes; as it is if it cannot be read.

    Args:
        line: Of a log that another program wrote anew.
        separator: What stands between its cells.
        comma: What a comma within a cell becomes.
    """
    try:
        cells = next(csv.reader([line], delimiter=separator), [])
    except csv.Error:  # a cell too long; a NUL on Python 3.10
        return line
    return ",".join(cell.replace(",", comma).strip() for cell in cells) + "\n"


def first_line(path: Path) -> tuple[str, bool]:
    """Returns the first line of a text, without its end, and whether there is more.

    Raises:
        UnreadableLog: There is no file, it cannot be read, or is no text in UTF-8.
    """
    try:
        if path.is_dir():
            raise UnreadableLog("this is a folder; name the CSV files in it")
        if not path.exists():
            raise MissingLog("there is no such file")
        if not path.is_file():
            raise UnreadableLog("this is not a regular file")
        with path.open("rb") as file:
            first, has_rows = file.readline(_LONGEST_HEADER), bool(file.read(1))
    except (OSError, ValueError) as error:  # a name too long, or with a NUL
        raise UnreadableLog(f"cannot be read: {reason_of(error)}") from error
    if packer := packer_of(first):
        raise UnreadableLog(f"it is packed by {packer}; unpack it first")
    if b"\0" in first:
        raise UnreadableLog("it is no text in UTF-8, perhaps UTF-16; save it as CSV in UTF-8")
    if b"\r" in first.rstrip(b"\r\n"):
        raise UnreadableLog("its lines end in carriage returns alone; save it anew as CSV in UTF-8")
    return first.decode("utf-8-sig", errors="replace").rstrip("\r\n"), has_rows


def _check_names(names: list[str], text: str) -> None:
    known = [name for name in names if name == STAMP or name in METRIC_COLUMNS]
    twice = sorted({name for name in known if known.count(name) > 1})
    if twice:
        raise UnreadableLog(f"the header names {', '.join(twice)} more than once")
    if STAMP in known and len(known) > 1:
        return
    if {"time_s", "speed_mps"}.issubset(names):
        raise UnreadableLog("it is a log of people around a rover; rover-social reads it")
    if not known:
        raise UnreadableLog(f"the first line is not the header of a metrics log but {shown(text)}")
    missing = STAMP if STAMP not in known else f"any of {', '.join(METRIC_COLUMNS)}"
    raise UnreadableLog(f"the header lacks {missing}")


def shown(text: str) -> str:
    """Quotes a piece of a file on one line, shortened and with control characters escaped."""
    cut = text if len(text) <= _MOST_SHOWN else text[:_MOST_SHOWN] + "..."
    return repr(cut)
