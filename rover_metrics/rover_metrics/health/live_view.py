"""What a row says to a person who watches: statuses with levels, as diagnostic_msgs has them. No ROS."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

from rover_metrics.core.columns import DECIMALS, Field, Row
from rover_metrics.core.thresholds import Thresholds
from rover_metrics.health.reception import TopicState
from rover_metrics.timing import age, rate


class Level(IntEnum):
    """The levels of diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2
    STALE = 3


@dataclass(frozen=True)
class Status:
    """One status."""

    level: Level
    name: str  # of its subject, without the node's
    message: str  # why the level is what it is
    values: tuple[tuple[str, str], ...]  # numbers in plain decimal, so that they can be plotted


_Complaint = tuple[Level, str]


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
            row: The latest.
            topics: What has arrived on each so far.
            thresholds: What is too much in a row.
            now_ns: Time on the ROS clock [ns].
        """
        traversal = self._traversal(row, thresholds)
        statuses = [traversal, *(self._topic(state, now_ns) for state in topics)]
        self._previous_ns = now_ns
        return statuses

    def _traversal(self, row: Row, thresholds: Thresholds) -> Status:
        cells = dict(zip(row.columns, row.as_fields(), strict=True))
        complaints = self._complaints(cells, thresholds)
        values = tuple((name, plain(value)) for name, value in cells.items() if value != "")
        return Status(
            max((level for level, _ in complaints), default=Level.OK),
            "traversal metrics",
            "; ".join(text for _, text in complaints) or "within all thresholds",
            values,
        )

    def _complaints(self, cells: dict[str, Field], thresholds: Thresholds) -> list[_Complaint]:
        """What is beyond a threshold; rough movement, for one, is worth a look and no error."""
        total = int(cells["Total Collisions"])
        new, self._collisions = total - self._collisions, total
        hit = "collision: the mean clearance is that of a contact"
        if new > 0:
            hit = f"collision: {new} scans since the row before"
        clearance, smoothness = float(cells["Obstacle Clearance"]), float(cells["Current Smoothness"])
        low = f"clearance {plain(clearance)} m is below min_safe_clearance"
        rough = f"smoothness {plain(smoothness)} is above smoothness_threshold"
        checks = (
            (new > 0 or cells["Current Collision Status"], Level.ERROR, hit),
            (clearance < thresholds.min_safe_clearance, Level.WARN, low),
            (cells["Is Rough Terrain"], Level.WARN, "rough terrain"),
            (smoothness > thresholds.smoothness_threshold, Level.WARN, rough),
        )
        return [(level, text) for holds, level, text in checks if holds]

    def _topic(self, state: TopicState, now_ns: int) -> Status:
        before = self._topics.get(state.topic, TopicState(state.topic))
        self._topics[state.topic] = state
        level, message = _judged(state, before)
        values = {
            "rate [Hz]": rate(state.received - before.received, self._previous_ns, now_ns),
            "age [s]": age(now_ns, state.stamp_ns),
            "lost": state.lost,
            "rejected": state.rejected,
            "publishers": state.publishers,
        }
        known = tuple((key, plain(value)) for key, value in values.items() if value is not None)
        name = f"topic {state.topic.strip('/').replace('/', ' ')}"  # a slash would make it a branch
        return Status(level, name, message, (("topic", state.topic), *known))


def plain(value: Field) -> str:
    """Returns a value as text that every plotting tool takes for a number, if it is one."""
    return f"{value:.{DECIMALS}f}" if isinstance(value, float) else str(value)


def _judged(state: TopicState, before: TopicState) -> _Complaint:
    if not state.received:
        return (Level.STALE, f"not heard yet, publishers: {state.publishers}")
    if state.is_silent:
        return (Level.STALE, f"silent, publishers: {state.publishers}")
    new = {"lost": state.lost - before.lost, "rejected": state.rejected - before.rejected}
    losses = [f"{count} {finding}" for finding, count in new.items() if count]
    if losses:
        return (Level.WARN, f"{' and '.join(losses)} since the row before")
    if state.publishers > 1:
        return (Level.WARN, f"{state.publishers} publishers, whose messages mix")
    return (Level.OK, "heard")
