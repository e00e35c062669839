"""When and where something happened: contacts as the simulator knows them, collisions as logged."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from harness.report.log import Log
from harness.report.recorder import Stretch
from harness.samples import Vector3

COUNTER = "Total Collisions"
LONGEST_GAP = 0.5  # [s]: what is interrupted for no longer is one event, as in harness.truth.events


@dataclass(frozen=True, slots=True)
class Event:
    """From when to when [s], and where the rover was [m]."""

    start_s: float
    end_s: float
    position: Vector3

    @property
    def label(self) -> str:
        """The time for people."""
        return f"{self.start_s:.1f} to {self.end_s:.1f} s"


def contacts(track: Sequence[Stretch]) -> list[Event]:
    """When the rover touched a hazard, and where it did so first."""
    starts = [0.0, *(stretch.time_s for stretch in track)]
    return _joined(
        Event(start_s, stretch.time_s, stretch.position)
        for start_s, stretch in zip(starts, track, strict=False)
        if stretch.contact_s > 0.0
    )


def collisions(log: Log, track: Sequence[Stretch]) -> list[Event]:
    """When the log's collision counter rose, and where a scan was nearest to something then."""
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
