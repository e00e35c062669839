"""Columns of the topics themselves: how fast they come, how old they are, what is missing of them."""

from collections import Counter
from collections.abc import Mapping
from typing import NamedTuple

from rover_metrics.core.columns import Cell, Column
from rover_metrics.health.watches import MISSING, StampWatch
from rover_metrics.timing import age, rate


class Topic(NamedTuple):
    """A sensor topic: its name in the columns, and by default."""

    title: str
    name: str


SCAN = Topic("Scan", "/scan")
IMU = Topic("IMU", "/imu/data")
POSE = Topic("Pose", "/rover/pose_array")
ODOMETRY = Topic("Odometry", "/odometry/wheels")
TOPICS = (SCAN, IMU, POSE, ODOMETRY)


def _columns(topic: Topic) -> tuple[Column, ...]:
    return (
        Column(
            name=f"{topic.title} Rate",
            unit="Hz",
            meaning=f"How often {topic.name} comes; 0 when it has stopped.",
            formula="Messages since the row before / time since then; empty in the first row.",
            source=topic.name,
            rate_invariant="it is the rate",
        ),
        Column(
            name=f"{topic.title} Age",
            unit="s",
            meaning=f"How old the newest reading of {topic.name} is.",
            formula="Time of the row - newest header stamp; empty without stamps, or with those of a "
            "clock that is more than a day away.",
            source=f"{topic.name} header.stamp",
            rate_invariant="no: up to a period",
        ),
        Column(
            name=f"{topic.title} Rejected",
            meaning=f"Messages of {topic.name} so far that were empty, not finite or impossible.",
            formula="Count of the messages that no metric used.",
            source=topic.name,
            rate_invariant="no: it counts messages",
            cumulative=True,
        ),
        Column(
            name=f"{topic.title} Lost",
            meaning=f"Messages of {topic.name} so far that never arrived.",
            formula="The larger of what the middleware reports and of what is missing by the gaps "
            "between stamps, in periods of their running median.",
            source=f"{topic.name} header.stamp",
            rate_invariant="no: it counts messages",
            cumulative=True,
        ),
    )


class TrafficColumns:
    """The columns about the four sensor topics themselves."""

    COLUMNS = tuple(column for topic in TOPICS for column in _columns(topic))

    def __init__(self) -> None:
        self._stamps = {topic: StampWatch() for topic in TOPICS}
        self._received, self._received_before = Counter[Topic](), Counter[Topic]()
        self._rejected, self._missing = Counter[Topic](), Counter[Topic]()
        self._previous_ns: int | None = None

    def add(self, topic: Topic, stamp_ns: int, *, used: bool) -> None:
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

    def cells(self, now_ns: int, reported_lost: Mapping[Topic, int]) -> tuple[Cell, ...]:
        """Returns the cells of a row at this time, with what the middleware says it has lost so far."""
        cells = [c for t in TOPICS for c in self._cells(t, now_ns, reported_lost.get(t, 0))]
        self._previous_ns, self._received_before = now_ns, self._received.copy()
        return tuple(cells)

    def _cells(self, topic: Topic, now_ns: int, reported_lost: int) -> tuple[Cell, ...]:
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
