"""What happened in a run: its metrics log and what the columns mean, collisions and true contacts."""

import csv
import math
import re
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
LONGEST_GAP = 0.5  # [s] in what is still one event, as in harness.truth.contact_events
MOST_NOTES = 20  # kinds


@dataclass(frozen=True)
class Column:
    """How a column of the log is drawn.

    Attributes:
        meaning: The caption.
        unit: Of its values; empty for a number without one.
        thresholds: Names of the thresholds that its values are compared with.
        is_flag: Whether it is 0 or 1.
        shows_gravity: Whether gravity is in its values.
    """

    meaning: str
    unit: str = ""
    thresholds: tuple[str, ...] = ()
    is_flag: bool = False
    shows_gravity: bool = False


KNOWN_COLUMNS = {
    "Total Collisions": Column(
        "Scans so far whose nearest range was below collision_threshold.", "scans"
    ),
    "Current Collision Status": Column(
        "1 while the windowed clearance is below collision_threshold.", is_flag=True
    ),
    "Smoothness Metric": Column("Sum of |a| + |ω| over all IMU samples so far.", "m/s² + rad/s"),
    "Current Smoothness": Column(
        "Mean of |a| + |ω| over the last 100 IMU samples.",
        "m/s² + rad/s",
        thresholds=("smoothness_threshold",),
    ),
    "Obstacle Clearance": Column(
        "Mean of the last 100 nearest ranges; a gap where nothing was ever in range (inf).",
        "m",
        thresholds=("collision_threshold", "min_safe_clearance"),
    ),
    "Distance Traveled": Column(
        "Path length so far, steps of distance_threshold or more left out.", "m"
    ),
    "Current Velocity": Column("Mean of the last 100 wheel odometry speeds.", "m/s"),
    "IMU Acceleration Magnitude": Column(
        "|a| of the latest IMU sample of each second, gravity included.",
        "m/s²",
        thresholds=("rough_terrain_threshold",),
        shows_gravity=True,
    ),
    "Is Rough Terrain": Column(
        "1 if |a| of that sample is above rough_terrain_threshold.", is_flag=True
    ),
    "Vertical Roughness": Column(
        "|az| of the latest IMU sample of each second, gravity included.", "m/s²", shows_gravity=True
    ),
}


def describe(name: str) -> Column:
    """Returns what is known of a column; an unknown one has the unit in its name's brackets."""
    unit = re.search(r"\[(.+)\]$", name)
    unknown = Column("A column beyond RoboTerrain's twelve.", unit[1] if unit else "")
    return KNOWN_COLUMNS.get(name, unknown)


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
    """From when to when [s], and where the rover was [m]."""

    start_s: float
    end_s: float
    position: Vector3


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
