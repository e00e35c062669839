"""Columns of the topics themselves: how fast they come, how old they are, what is missing of them."""

from collections import Counter
from collections.abc import Mapping

from rover_metrics.core.columns import Cell, Column
from rover_metrics.health.watches import MISSING, StampWatch
from rover_metrics.timing import age, rate

SCAN, IMU, POSE, ODOMETRY = "/scan", "/imu/data", "/rover/pose_array", "/odometry/wheels"
TOPICS = {SCAN: "Scan", IMU: "IMU", POSE: "Pose", ODOMETRY: "Odometry"}  # as their columns are called


def _columns(topic: str, title: str) -> tuple[Column, ...]:
    return (
        Column(
            name=f"{title} Rate",
            unit="Hz",
            meaning=f"How often {topic} comes; 0 when it has stopped.",
            formula="Messages since the row before / time since then; empty in the first row.",
            source=topic,
            rate_invariant="it is the rate",
        ),
        Column(
            name=f"{title} Age",
            unit="s",
            meaning=f"How old the newest reading of {topic} is.",
            formula="Time of the row - newest header stamp; empty without stamps, or with those of a "
            "clock that is more than a day away.",
            source=f"{topic} header.stamp",
            rate_invariant="no: up to a period",
        ),
        Column(
            name=f"{title} Rejected",
            meaning=f"Messages of {topic} so far that were empty, not finite or impossible.",
            formula="Count of the messages that no metric used.",
            source=topic,
            rate_invariant="no: it counts messages",
            cumulative=True,
        ),
        Column(
            name=f"{title} Lost",
            meaning=f"Messages of {topic} so far that never arrived.",
            formula="The larger of what the middleware reports and of what is missing by the gaps "
            "between stamps, in periods of their running median.",
            source=f"{topic} header.stamp",
            rate_invariant="no: it counts messages",
            cumulative=True,
        ),
    )


class TrafficColumns:
    """The columns about the four sensor topics themselves."""

    COLUMNS = tuple(column for topic in TOPICS.items() for column in _columns(*topic))

    def __init__(self) -> None:
        self._stamps = {topic: StampWatch() for topic in TOPICS}
        self._received, self._received_before = Counter[str](), Counter[str]()
        self._rejected, self._missing = Counter[str](), Counter[str]()
        self._previous_ns: int | None = None

    def add(self, topic: str, stamp_ns: int, *, used: bool) -> None:
        """Takes a message.

        Args:
            topic: Where it came.
            stamp_ns: Stamp of the header [ns].
            used: Whether the metrics have used it.
        """
        self._received[topic] += 1
        self._rejected[topic] += not used
        finding = self._stamps[topic].take(stamp_ns)
        if finding is not None and finding[0] == MISSING:
            self._missing[topic] += finding[1]

    def cells(self, now_ns: int, reported_lost: Mapping[str, int]) -> tuple[Cell, ...]:
        """Returns the cells of a row at this time, with what the middleware says it has lost so far."""
        cells = [c for t in TOPICS for c in self._cells(t, now_ns, reported_lost.get(t, 0))]
        self._previous_ns, self._received_before = now_ns, self._received.copy()
        return tuple(cells)

    def _cells(self, topic: str, now_ns: int, reported_lost: int) -> tuple[Cell, ...]:
        stamps, received = self._stamps[topic], self._received[topic]
        stamps.learn()
        if not received:
            return (None, None, None, None)
        return (
            rate(received - self._received_before[topic], self._previous_ns, now_ns),
            age(now_ns, stamps.latest_ns),
            self._rejected[topic],
            max(self._missing[topic], reported_lost),
        )
