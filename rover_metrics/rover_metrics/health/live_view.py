"""What a row says to whoever watches: statuses with levels, as diagnostic_msgs has them. No ROS."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from rover_metrics.core.row import DECIMALS, Field, Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.health.reception import TopicState
from rover_metrics.timing.clocks import OTHER_CLOCK


class Level(IntEnum):
    """The levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class Status:
    """One status.

    Attributes:
        level: How bad it is.
        name: Of what it is the status, without the node's name.
        message: Why the level is what it is.
        values: Key and value, both text; numbers in plain decimal, so that they can be plotted.
    """

    level: Level
    name: str
    message: str
    values: tuple[tuple[str, str], ...]


class _Complaint(NamedTuple):
    level: Level
    text: str


class LiveView:
    """Turns each row of a session, and what has arrived, into statuses."""

    def __init__(self) -> None:
        self._collisions = 0
        self._topics: dict[str, TopicState] = {}
        self._previous_ns: int | None = None

    def statuses(
        self, row: Row, topics: Iterable[TopicState], thresholds: Thresholds, now_ns: int
    ) -> list[Status]:
        """Returns the status of the traversal, then one for each topic.

        Args:
            row: The latest row.
            topics: What is known of each topic now.
            thresholds: What is compared with what.
            now_ns: ROS time of the row [ns].
        """
        previous, self._previous_ns = self._previous_ns, now_ns
        interval = None if previous is None or now_ns <= previous else (now_ns - previous) / 1e9
        traversal = self._traversal(row, thresholds)
        return [traversal, *(self._topic(state, now_ns, interval) for state in topics)]

    def _traversal(self, row: Row, thresholds: Thresholds) -> Status:
        cells = dict(zip(row.columns, row.as_fields(), strict=True))
        complaints = [*self._collision(cells), *_exceeded(cells, thresholds)]
        values = tuple((name, plain(value)) for name, value in cells.items() if value != "")
        return Status(
            max((complaint.level for complaint in complaints), default=Level.OK),
            "traversal metrics",
            "; ".join(complaint.text for complaint in complaints) or "within all thresholds",
            values,
        )

    def _collision(self, cells: dict[str, Field]) -> list[_Complaint]:
        total = int(cells["Total Collisions"])
        new, self._collisions = total - self._collisions, total
        if new > 0:
            return [_Complaint(Level.ERROR, f"collision: {new} scans since the row before")]
        if cells["Current Collision Status"]:
            return [_Complaint(Level.ERROR, "collision: the mean clearance is that of a contact")]
        return []

    def _topic(self, state: TopicState, now_ns: int, interval: float | None) -> Status:
        before = self._topics.get(state.topic)
        self._topics[state.topic] = state
        level, message = _judged(state, before)
        came = state.received - (0 if before is None else before.received)
        values = {
            "rate [Hz]": None if interval is None else came / interval,
            "age [s]": _age(state, now_ns),
            "lost": state.lost,
            "rejected": state.rejected,
            "publishers": state.publishers,
        }
        told = tuple((key, plain(value)) for key, value in values.items() if value is not None)
        name = f"topic {state.topic.strip('/').replace('/', ' ')}"  # a slash would make it a branch
        return Status(level, name, message, (("topic", state.topic), *told))


def plain(value: Field) -> str:
    """Returns a value as text that every plotting tool takes for a number, if it is one."""
    return f"{value:.{DECIMALS}f}" if isinstance(value, float) else str(value)


def _exceeded(cells: dict[str, Field], thresholds: Thresholds) -> list[_Complaint]:
    """What is beyond a threshold; rough movement, for one, is worth a look and no error."""
    clearance, smoothness = float(cells["Obstacle Clearance"]), float(cells["Current Smoothness"])
    complaints = []
    if clearance < thresholds.min_safe_clearance:
        complaints.append(f"clearance {plain(clearance)} m is below min_safe_clearance")
    if cells["Is Rough Terrain"]:
        complaints.append("rough terrain")
    if smoothness > thresholds.smoothness_threshold:
        complaints.append(f"smoothness {plain(smoothness)} is above smoothness_threshold")
    return [_Complaint(Level.WARN, text) for text in complaints]


def _judged(state: TopicState, before: TopicState | None) -> _Complaint:
    if not state.received:
        return _Complaint(Level.STALE, f"not heard yet, publishers: {state.publishers}")
    if state.is_silent:
        return _Complaint(Level.STALE, f"silent, publishers: {state.publishers}")
    lost = state.lost - (before.lost if before is not None else 0)
    rejected = state.rejected - (before.rejected if before is not None else 0)
    told = [f"{count} {what}" for count, what in ((lost, "lost"), (rejected, "rejected")) if count]
    if told:
        return _Complaint(Level.WARN, f"{' and '.join(told)} since the row before")
    if state.publishers > 1:
        return _Complaint(Level.WARN, f"{state.publishers} publishers, whose messages mix")
    return _Complaint(Level.OK, "heard")


def _age(state: TopicState, now_ns: int) -> float | None:
    """Of the newest stamp [s]; None where none was told, or by another clock."""
    if not state.stamp_ns:
        return None
    age = (now_ns - state.stamp_ns) / 1e9
    return age if abs(age) <= OTHER_CLOCK else None
