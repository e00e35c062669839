"""The rows of a CSV file as a Table, read in chunks so that memory is that of the numbers alone.

pandas takes a field too many for an index and shifts every column without a word, and refuses a file
for two too many. Here one column more than the header names catches such fields, and the rows that have
them are left out. Quotes reach no further than their line, so that a stray one cannot swallow lines and
each row knows its line; outside of the notes they only mean something where a row begins with one.
"""

import csv
import io
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, TextIO

import numpy as np
import pandas as pd

from rover_metrics.analysis.logs.header import (
    UnreadableLog,
    as_logged,
    comma_in_cells,
    first_line,
    separator_of,
    shown,
)
from rover_metrics.analysis.metric import METRIC_COLUMNS, NOTES, STAMP
from rover_metrics.errors import counted

_CHUNK = 200_000  # rows
_LONGEST_LINE = 1 << 16  # bytes
_FIRST_ROW_LINE = 2  # of the file, as editors count
_EXTRA = "\0extra"  # no header can name a column so


@dataclass
class Tally:
    """How often something was met, and where first."""

    count: int = 0
    first: int = 0
    example: str = ""

    def add(self, lines: "pd.Index[int]", example: str = "") -> None:
        """Counts some lines, ascending."""
        if lines.size and not self.count:
            self.first, self.example = int(lines[0]), example
        self.count += lines.size

    def describe(self, noun: str, oddity: str = "", outcome: str = "left out") -> list[str]:
        """Returns a line that says how many there are and where the first is; none if there are none.

        Args:
            noun: What was counted, in the singular.
            oddity: What is odd about it, with a space in front.
            outcome: What follows from it.
        """
        if not self.count:
            return []
        where = f"line {self.first}" if self.count == 1 else f"first on line {self.first}"
        example = f", {self.example}" if self.example else ""
        return [f"{counted(self.count, noun)}{oddity} ({where}{example}): {outcome}"]


@dataclass
class Table:
    """The usable rows of a file, and a tally of what was not usable.

    A row has its Timestamp [s], finite, and the columns asked for, NaN where the file has no finite
    number. Its index is the line of the file that it stands on, from 1.
    """

    cells: dict[str, Tally]  # without a number, by column asked for
    infinite: dict[str, Tally]  # cells that are infinite, by column asked for
    rows: pd.DataFrame = field(default_factory=pd.DataFrame)
    total: int = 0  # rows of the file
    long: Tally = field(default_factory=Tally)  # rows with more fields than the header
    short: Tally = field(default_factory=Tally)  # with fewer, of the last one's being cut short too
    untimed: Tally = field(default_factory=Tally)  # other rows without a finite time
    blank: Tally = field(default_factory=Tally)  # lines with nothing in them, as of Python on Windows
    spaces: bool = False  # whether cells of the first row begin with a space


def read_table(path: Path, header: Sequence[str], wanted: Sequence[str]) -> Table:
    """Reads the rows of a log.

    Args:
        path: The file.
        header: Its column names.
        wanted: Columns to keep, all of them in the header, as float64: findings quote
            its own numbers (2.4998), not their neighbours in float32 (2.4998000860).

    Raises:
        UnreadableLog: The file cannot be read as lines of fields.
    """
    table = Table(cells={name: Tally() for name in wanted}, infinite={name: Tally() for name in wanted})
    try:
        separator = separator_of(first_line(path)[0])
        with path.open("rb") as file:
            file.readline()
            comma = comma_in_cells(file, separator)
        with path.open(encoding="utf-8", errors="replace", newline="") as text:
            chunks = _chunks(_Narrow(text, len(header) + 1, separator, comma), header)
            table.rows = pd.concat([_usable(chunk, table) for chunk in chunks])
        with path.open("rb") as file:
            file.readline()
            table.spaces = b", " in file.readline(_LONGEST_LINE).rpartition(b",")[0]
            is_cut = _last_line_is_cut(file, len(header), separator.encode())
    except (OSError, ValueError, MemoryError) as error:  # pandas' ParserError is a ValueError
        reason = " ".join(str(error).split()) or "out of memory"
        raise UnreadableLog(f"cannot be read: {reason}") from error
    if is_cut:
        last = table.rows.index == table.total + 1
        table.short.add(table.rows.index[last])
        table.rows = table.rows[~last]
    return table


def _last_line_is_cut(file: BinaryIO, fields: int, separator: bytes) -> bool:
    """Whether a file ends in the middle of a line; its last number may be half a number."""
    file.seek(-min(_LONGEST_LINE, file.seek(0, os.SEEK_END)), os.SEEK_END)
    last = file.read().rpartition(b"\n")[2]
    return bool(last) and last.count(separator) < fields - 1


class _Narrow(io.TextIOBase):
    """A text with commas between cells, a line cut after some; pandas refuses more than it has names."""

    def __init__(self, file: TextIO, fields: int, separator: str, comma: str) -> None:
        self._file, self._fields, self._separator, self._comma = file, fields, separator, comma

    def read(self, size: int | None = -1) -> str:
        """Returns whole lines of about `size` characters; all there are without a size."""
        lines = self._file.readlines(-1 if size is None else size)
        for place, line in enumerate(lines):
            if (self._separator, self._comma) != (",", ";") or line.startswith('"'):
                lines[place] = line = as_logged(line, self._separator, self._comma)  # noqa: PLW2901
            if line.count(",") >= self._fields:
                lines[place] = ",".join(line.split(",", self._fields)[: self._fields]) + "\n"
        # An older pandas takes a NUL for the end of a cell, and a line of them for a blank one.
        return "".join(lines).replace("\0", "\ufffd")


def _chunks(file: _Narrow, header: Sequence[str]) -> Iterator[pd.DataFrame]:
    names = [name if header.count(name) == 1 else f"\0{i}" for i, name in enumerate(header)]
    return pd.read_csv(
        file,
        names=[*names, _EXTRA],
        header=None,
        skiprows=1,
        index_col=False,
        chunksize=_CHUNK,
        skipinitialspace=True,
        skip_blank_lines=False,
        quoting=csv.QUOTE_NONE,
        low_memory=False,
    )


def _usable(chunk: pd.DataFrame, table: Table) -> pd.DataFrame:
    """Returns times and columns of the usable rows of a chunk, by line; tallies the others."""
    chunk.index += _FIRST_ROW_LINE
    table.total += len(chunk)
    twelve = [name for name in (STAMP, *METRIC_COLUMNS) if name in chunk.columns]
    numbers = chunk[list(dict.fromkeys((*twelve, *table.cells)))].apply(pd.to_numeric, errors="coerce")
    numbers = numbers.astype(np.float64)
    # Columns after the notes are extended ones, which may well be empty.
    last = chunk[NOTES] if NOTES in chunk.columns else chunk.iloc[:, -2]
    long, blank = _has_extra_field(chunk), chunk.isna().all(axis=1)
    short = ~long & ~blank & last.isna() & numbers[twelve].isna().any(axis=1)
    untimed = ~long & ~blank & ~short & ~np.isfinite(numbers[STAMP])
    tallies = (table.long, long), (table.blank, blank), (table.short, short), (table.untimed, untimed)
    for tally, rows in tallies:
        tally.add(chunk.index[rows])
    keep = ~(long | blank | short | untimed)
    numbers = numbers.loc[keep, [STAMP, *table.cells]]
    for name in table.cells:
        _tally_cells(chunk[name][keep], numbers[name], table)
    finite: pd.DataFrame = numbers.where(np.isfinite(numbers))
    return finite


def _has_extra_field(chunk: pd.DataFrame) -> "pd.Series[bool]":
    """Marks rows with more fields than the header; commas inside a quoted note do not count."""
    extra = chunk[_EXTRA].notna()
    if extra.any():
        extra &= ~chunk.iloc[:, -2].astype(str).str.startswith('"')
    return extra


def _tally_cells(column: "pd.Series[float]", numbers: "pd.Series[float]", table: Table) -> None:
    name, missing = str(column.name), numbers.isna()
    if name not in METRIC_COLUMNS:
        missing &= column.notna()  # an empty cell of another column is nothing odd
    if missing.any():
        texts = column[missing].dropna()
        table.cells[name].add(column.index[missing], shown(str(texts.iloc[0])) if len(texts) else "")
    table.infinite[name].add(column.index[np.isinf(numbers)])
