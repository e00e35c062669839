"""What happened in a run: its metrics log and what the columns mean, collisions and true contacts."""

import csv
import math
import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

from harness.page.run.recorder import Stretch
from harness.samples import Vector3
from rover_metrics.analysis.metric import METRICS
from rover_metrics.analysis.social.metrics import PERSONAL_SPACE
from rover_metrics.core.columns import COLUMNS, ROBOTERRAIN_COLUMNS, Column
from rover_metrics.extended.metrics import ALL_COLUMNS
from rover_metrics.extended.truth_columns import find_truth_column
from rover_metrics.sheet.sheet import spelled
from rover_metrics.timing import EVENT_GAP_NS, NANOSECONDS

TIME_COLUMN, NOTES_COLUMN = COLUMNS[0], COLUMNS[-1]
COUNTER = "Total Collisions"
MOST_NOTES = 20  # kinds

# The thresholds that the values of a column are compared with.
THRESHOLDS = {metric.column: metric.thresholds for metric in METRICS.values() if metric.thresholds}
WITH_GRAVITY = ("Current Smoothness", "IMU Acceleration Magnitude", "Vertical Roughness")
DICTIONARY = {column.name: column for column in ROBOTERRAIN_COLUMNS} | {
    column.header: column for column in ALL_COLUMNS
}


def describe(name: str) -> Column:
    """Returns the entry of the data dictionary; what it does not know has the unit in its name."""
    if column := DICTIONARY.get(name) or find_truth_column(name):  # by the rover's wheels
        return column
    unit = re.search(r"\[(.+)\]$", name)
    meaning = "The data dictionary does not know this column."
    return Column(name=name, unit=unit[1] if unit else "", meaning=meaning, formula="", source="the log")


def caption(name: str) -> str:
    """Returns what a column is and how it is computed."""
    column = describe(name)
    return spelled(f"{column.meaning} {column.formula}".strip())


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
    with path.open(newline="") as file:
        reader = csv.DictReader(file, restval="")
        names, rows = reader.fieldnames or (), list(reader)
    columns = {name: [_number(row[name]) for row in rows] for name in names if name != NOTES_COLUMN}
    notes = Counter(row.get(NOTES_COLUMN, "") for row in rows)
    return Log(columns.pop(TIME_COLUMN, []), columns, notes.most_common(MOST_NOTES))


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


@dataclass(frozen=True, slots=True)
class Event:
    """Something that lasted: from when to when [s], and where the rover was [m]."""

    start_s: float
    end_s: float
    position: Vector3


def contacts(track: Sequence[Stretch]) -> list[Event]:
    """Returns when the rover touched a hazard, and where it did so first."""
    return _while(track, lambda stretch: stretch.contact_s > 0.0)


def meetings(track: Sequence[Stretch]) -> list[Event]:
    """Returns when a person was in the rover's personal space, and where the rover was at first."""
    return _while(track, lambda stretch: stretch.nearest_person < PERSONAL_SPACE)


def _while(track: Sequence[Stretch], holds: Callable[[Stretch], bool]) -> list[Event]:
    starts = [0.0, *(stretch.time_s for stretch in track)]
    return _joined(
        Event(start_s, stretch.time_s, stretch.position)
        for start_s, stretch in zip(starts, track, strict=False)
        if holds(stretch)
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
        if joined and event.start_s - joined[-1].end_s <= EVENT_GAP_NS / NANOSECONDS:
            joined[-1] = replace(joined[-1], end_s=event.end_s)
        else:
            joined.append(event)
    return joined
