"""A metrics log as the report reads it back: numbers by column, notes by how often they were made."""

import csv
import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from harness.report.columns import NOTES_COLUMN, TIME_COLUMN

MOST_NOTES = 20  # kinds


@dataclass(frozen=True)
class Log:
    """The rows of a run.

    Attributes:
        time_s: Timestamp of each row [s].
        columns: Values by column name, in the log's order; what is no number is NaN.
        notes: The most frequent notes with their counts.
    """

    time_s: list[float] = field(default_factory=list)
    columns: dict[str, list[float]] = field(default_factory=dict)
    notes: list[tuple[str, int]] = field(default_factory=list)


def read_log(path: Path | None) -> Log:
    """Reads a log; without one there is nothing in it."""
    if path is None or not path.is_file():
        return Log()
    notes: Counter[str] = Counter()
    with path.open(newline="") as file:
        rows = csv.reader(file)
        names = next(rows, [])
        values: dict[str, list[float]] = {name: [] for name in names if name != NOTES_COLUMN}
        for row in rows:
            cells = dict(zip(names, row, strict=False))
            notes[cells.get(NOTES_COLUMN, "")] += 1
            for name, numbers in values.items():
                numbers.append(_number(cells.get(name, "")))
    return Log(values.pop(TIME_COLUMN, []), values, notes.most_common(MOST_NOTES))


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan
