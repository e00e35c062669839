"""What happened in a run: the values and collisions of its metrics log, the contacts of the truth."""

import csv
import math
from bisect import bisect_right
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from harness.report.recorder import Stretch
from harness.samples import Vector3
from rover_metrics.core.row import COLUMNS

TIME_COLUMN, NOTES_COLUMN = COLUMNS[0], COLUMNS[-1]
COUNTER = "Total Collisions"
LONGEST_GAP = (
    0.5  # [s]: what is interrupted for no longer is one event, as in harness.truth.contact_events
)
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
    """Returns the log of a run; without a file there is nothing in it."""
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


@dataclass(frozen=True, slots=True)
class Event:
    """From when to when [s], and where the rover was [m]."""

    start_s: float
    end_s: float
    position: Vector3

    @property
    def label(self) -> str:
        """Its time, as the pages show it."""
        return f"{self.start_s:.1f} to {self.end_s:.1f} s"


def contacts(track: Sequence[Stretch]) -> list[Event]:
    """Returns when the rover touched a hazard, and where it did so first."""
    starts = [0.0, *(stretch.time_s for stretch in track)]
    return _joined(
        Event(start_s, stretch.time_s, stretch.position)
        for start_s, stretch in zip(starts, track, strict=False)
        if stretch.contact_s > 0.0
    )


def collisions(log: Log, track: Sequence[Stretch]) -> list[Event]:
    """Returns when the log's collision counter rose, and where a scan was nearest to something then."""
    rows = zip(log.time_s, log.columns.get(COUNTER, []), strict=False)
    return _joined(
        Event(start_s, end_s, min(within, key=lambda stretch: stretch.nearest_range).position)
        for (start_s, before), (end_s, after) in pairwise([(0.0, 0.0), *rows])
        if after > before and (within := _between(track, start_s, end_s))
    )


def _between(track: Sequence[Stretch], start_s: float, end_s: float) -> Sequence[Stretch]:
    """The stretches that end in an interval; the one that covers it if none does."""
    first, last = (bisect_right(track, t, key=lambda stretch: stretch.time_s) for t in (start_s, end_s))
    return track[first : max(last, first + 1)]


def _joined(events: Iterable[Event]) -> list[Event]:
    joined: list[Event] = []
    for event in events:
        if joined and event.start_s - joined[-1].end_s <= LONGEST_GAP:
            joined[-1] = replace(joined[-1], end_s=event.end_s)
        else:
            joined.append(event)
    return joined
