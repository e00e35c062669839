"""The rows of a CSV file as a Table, read in chunks so that memory is that of the numbers alone.

pandas takes a field too many for an index and shifts every column without a word. Here one column
more than the header names catches such fields, and the rows that have them are left out. Quotes have
no meaning, so that a stray one cannot swallow lines and each row knows its line.
"""

import csv
import os
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from rover_metrics.analysis.logs.header import UnreadableLog, shown
from rover_metrics.analysis.logs.log import Floats, Integers
from rover_metrics.analysis.logs.table import Table, Tally
from rover_metrics.analysis.metric import COUNTERS, EXTENDED_COLUMNS, METRIC_COLUMNS, NOTES, STAMP

_CHUNK = 200_000  # rows
_LONGEST_LINE = 1 << 16  # bytes
_FIRST_ROW_LINE = 2  # of the file, as editors count
_EXTRA = "\0extra"  # no header can name a column so


def read_table(path: Path, header: Sequence[str], wanted: Sequence[str]) -> Table:
    """Read the rows of a log.

    Args:
        path: The file.
        header: Its column names.
        wanted: Columns to keep, all of them in the header: counters as float64, for they grow
            large, the others as float32.

    Raises:
        UnreadableLog: The file cannot be read as lines of fields.
    """
    table = Table(cells={name: Tally() for name in wanted}, infinite={name: Tally() for name in wanted})
    try:
        with warnings.catch_warnings():
            # Fields beyond the extra column are lost; for the extra one the row is left out anyway.
            warnings.simplefilter("ignore", pd.errors.ParserWarning)
            parts = [_usable(chunk, table) for chunk in _chunks(path, header)]
        table.spaces = _has_spaces(path)
        is_cut = _last_line_is_cut(path, len(header))
    except (OSError, ValueError, MemoryError) as error:  # pandas' ParserError is a ValueError
        reason = " ".join(str(error).split()) or "out of memory"
        raise UnreadableLog(f"cannot be read: {reason}") from error
    _join(table, parts)
    if is_cut:
        last = table.lines == table.total + 1
        table.short.add(table.lines[last])
        table.keep(~last)
    return table


def _has_spaces(path: Path) -> bool:
    with path.open("rb") as file:
        file.readline()
        return b", " in file.readline(_LONGEST_LINE).rpartition(b",")[0]


def _last_line_is_cut(path: Path, fields: int) -> bool:
    """Tell whether the file ends in the middle of a line; its last number may be half a number."""
    with path.open("rb") as file:
        file.seek(-min(_LONGEST_LINE, file.seek(0, os.SEEK_END)), os.SEEK_END)
        last = file.read().rpartition(b"\n")[2]
    return bool(last) and last.count(b",") < fields - 1


def _chunks(path: Path, header: Sequence[str]) -> Iterator[pd.DataFrame]:
    names = [name if header.count(name) == 1 else f"\0{i}" for i, name in enumerate(header)]
    return pd.read_csv(
        path,
        names=[*names, _EXTRA],
        header=None,
        skiprows=1,
        index_col=False,
        chunksize=_CHUNK,
        skipinitialspace=True,
        skip_blank_lines=False,
        quoting=csv.QUOTE_NONE,
        encoding="utf-8",
        encoding_errors="replace",
        low_memory=False,
    )


Part = tuple[Integers, Floats, dict[str, NDArray[np.floating]]]


def _usable(chunk: pd.DataFrame, table: Table) -> Part:
    """Give lines, times and columns of the usable rows of a chunk; tallies the others."""
    lines = np.arange(len(chunk), dtype=np.int64) + table.total + _FIRST_ROW_LINE
    table.total += len(chunk)
    known = [name for name in (STAMP, *METRIC_COLUMNS) if name in chunk.columns]
    numbers = {name: _numbers(chunk[name]) for name in known}
    lacks_number = np.any([np.isnan(column) for column in numbers.values()], axis=0)
    numbers |= {name: _numbers(chunk[name]) for name in EXTENDED_COLUMNS if name in table.cells}
    # Columns after the notes are extended ones, which may well be empty.
    last = chunk[NOTES] if NOTES in chunk.columns else chunk.iloc[:, -2]
    long = _has_extra_field(chunk)
    short = ~long & last.isna().to_numpy(dtype=bool) & lacks_number
    untimed = ~long & ~short & ~np.isfinite(numbers[STAMP])
    for tally, rows in ((table.long, long), (table.short, short), (table.untimed, untimed)):
        tally.add(lines[rows])
    keep = ~(long | short | untimed)
    columns = {}
    for name in table.cells:
        column = numbers[name][keep]
        _tally_cells(chunk[name][keep], column, lines[keep], table)
        columns[name] = np.where(np.isinf(column), np.nan, column).astype(_dtype(name))
    return lines[keep], numbers[STAMP][keep], columns


def _has_extra_field(chunk: pd.DataFrame) -> NDArray[np.bool_]:
    """Mark rows with more fields than the header; commas inside a quoted note do not count."""
    extra = chunk[_EXTRA].notna().to_numpy(dtype=bool)
    if extra.any():
        quoted = chunk.iloc[:, -2].astype(str).str.startswith('"').to_numpy(dtype=bool)
        extra = extra & ~quoted
    return np.asarray(extra)


def _numbers(column: "pd.Series[float]") -> Floats:
    """Give a column as numbers, NaN where it holds text; pandas has parsed the clean ones already."""
    if not pd.api.types.is_numeric_dtype(column):
        column = pd.to_numeric(column, errors="coerce")
    return np.asarray(column, dtype=np.float64)


def _tally_cells(column: "pd.Series[float]", numbers: Floats, lines: Integers, table: Table) -> None:
    name, missing = str(column.name), np.isnan(numbers)
    if name in EXTENDED_COLUMNS:
        missing &= column.notna().to_numpy(dtype=bool)  # an empty cell of those is nothing odd
    if missing.any():
        texts = column[missing].dropna()
        table.cells[name].add(lines[missing], shown(str(texts.iloc[0])) if len(texts) else "")
    table.infinite[name].add(lines[np.isinf(numbers)])


def _dtype(column: str) -> type[np.floating]:
    return np.float64 if column in COUNTERS else np.float32


def _join(table: Table, parts: Sequence[Part]) -> None:
    """Put the parts into the table, a column at a time so that no more than one is held twice."""
    if parts:
        table.lines = np.concatenate([part[0] for part in parts])
        table.stamps = np.concatenate([part[1] for part in parts])
        for name in table.cells:
            table.columns[name] = np.concatenate([part[2].pop(name) for part in parts])
