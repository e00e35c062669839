"""Plays a recording into TraversalMetrics: messages in recorded order, a row at each full second.

How rows are timed: a row is due when the chosen time reaches a full second, and holds every message up
to and including that instant. Nothing is due before the first full second after the start, nor for a
last second that is not full. With simulated time /clock moves the same timer as in the live node; with
recorded or header time a second is full when a message comes from after it, or at the end. A recording
of harness.run thus gives the rows of the live run in each of the three ways.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Any, NamedTuple

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore

from rover_metrics.bag_reader import Bag, BagError, Message
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.row import MetricsRow

NANOSECONDS = 1_000_000_000
LONGEST_GAP = 60  # seconds without a message in which rows go on, as those of a live node would
OTHER_CLOCK = 3600 * NANOSECONDS  # header and recorded time that far apart are not the same clock
MOST_NOTES = 5
CLOCK, CLOCK_TYPE = "/clock", "rosgraph_msgs/msg/Clock"


class Sensor(NamedTuple):
    """What the metrics take from a topic: its message type, and how a message is taken.

    `take` gives False for a message that is left out because it is empty, not finite or impossible.
    """

    message_type: str
    take: Callable[[TraversalMetrics, Any], bool]


def _take_scan(metrics: TraversalMetrics, scan: Any) -> bool:  # noqa: ANN401 - rosbags makes the type
    metrics.add_scan(scan.ranges)
    return True  # a scan without a finite range is open space, not a fault


def _take_imu(metrics: TraversalMetrics, imu: Any) -> bool:  # noqa: ANN401
    a, w = imu.linear_acceleration, imu.angular_velocity
    return metrics.add_imu((a.x, a.y, a.z), (w.x, w.y, w.z))


def _take_pose(metrics: TraversalMetrics, poses: Any) -> bool:  # noqa: ANN401
    position = poses.poses[0].position if poses.poses else None
    return position is not None and metrics.add_pose((position.x, position.y, position.z))


def _take_odometry(metrics: TraversalMetrics, odometry: Any) -> bool:  # noqa: ANN401
    v = odometry.twist.twist.linear
    return metrics.add_odometry((v.x, v.y, v.z))


SENSORS: Mapping[str, Sensor] = {
    "/scan": Sensor("sensor_msgs/msg/LaserScan", _take_scan),
    "/imu/data": Sensor("sensor_msgs/msg/Imu", _take_imu),
    "/rover/pose_array": Sensor("geometry_msgs/msg/PoseArray", _take_pose),
    "/odometry/wheels": Sensor("nav_msgs/msg/Odometry", _take_odometry),
}


class TimeSource(Enum):
    """Which time the rows follow."""

    AUTO = "auto"  # SIM where the recording has /clock, else RECORDED
    SIM = "sim"  # /clock
    RECORDED = "recorded"  # when each message was recorded
    HEADER = "header"  # the header stamps of the sensors' messages


@dataclass
class Count:
    """Messages of one topic: used, left out as the node would, and not readable."""

    used: int = 0
    rejected: int = 0
    unreadable: int = 0


class FullSeconds:
    """Tells which rows are due as recorded or header time goes on: one for each second that is full.

    Attributes:
        jumps: Where time went back, or ahead by more than LONGEST_GAP; a line each.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._latest_ns: int | None = None
        self._second = 0

    def due(self, time_ns: int) -> range:
        """Take the time of the next message; gives the seconds that are full before it.

        A time that is up to a second older than the latest is late, not a jump: it moves nothing.
        """
        second, previous, latest = (time_ns - 1) // NANOSECONDS, self._second, self._latest_ns
        if latest is None or time_ns < latest - NANOSECONDS:
            second = previous = time_ns // NANOSECONDS
        elif time_ns < latest:
            return range(0)
        elif second - previous > LONGEST_GAP:
            previous = second - 1
        if latest is not None and (time_ns < latest or previous != self._second):
            self.jumps.append(_jump(latest, time_ns))
        self._latest_ns, self._second = time_ns, second
        return range(previous + 1, second + 1)

    def rest(self) -> range:
        """The second that ends with the recording, if one does."""
        if self._latest_ns is None:
            return range(0)
        return range(self._second + 1, self._latest_ns // NANOSECONDS + 1)


class RosTimer:
    """Tells which rows are due as /clock goes on: what the node's timer of one second does.

    After a jump ahead the rows missed are skipped; after one back the next comes a second later.

    Attributes:
        jumps: Where time went back, or ahead by more than a second; a line each.
    """

    def __init__(self) -> None:
        self.jumps: list[str] = []
        self._latest_ns: int | None = None
        self._called_ns = self._next_ns = 0

    def due(self, time_ns: int) -> range:
        """Take the next time of /clock; gives the second whose row is due, if one is."""
        if self._latest_ns is None:
            self._called_ns = time_ns
            self._next_ns = (time_ns // NANOSECONDS + 1) * NANOSECONDS
        elif abs(time_ns - self._latest_ns) > NANOSECONDS:
            self.jumps.append(_jump(self._latest_ns, time_ns))
        self._latest_ns = time_ns
        if time_ns < self._called_ns:
            self._called_ns, self._next_ns = time_ns, time_ns + NANOSECONDS
        if time_ns < self._next_ns:
            return range(0)
        self._called_ns = time_ns
        self._next_ns += ((time_ns - self._next_ns) // NANOSECONDS + 1) * NANOSECONDS
        second = time_ns // NANOSECONDS
        return range(second, second + 1)

    def rest(self) -> range:
        """Nothing: a timer does not fire at the end."""
        return range(0)


class Playback:
    """One pass through a recording.

    Args:
        bag: The recording.
        metrics: Where the samples go.
        remaps: Recorded topic by the topic that the metrics node listens to, both absolute.
        time_source: Which time the rows follow.

    Attributes:
        metrics: As given.
        time_source: The one in use, never AUTO.
        counts: Messages by recorded topic, of the topics in use.
        missing: Why a topic is not in use; a line each.

    Raises:
        BagError: The recording has none of the topics, or not what the time source needs.
    """

    def __init__(
        self,
        bag: Bag,
        metrics: TraversalMetrics,
        remaps: Mapping[str, str] = MappingProxyType({}),
        time_source: TimeSource = TimeSource.AUTO,
    ) -> None:
        self._bag, self.metrics = bag, metrics
        wished = {remaps.get(name, name): sensor for name, sensor in SENSORS.items()}
        if len(wished) < len(SENSORS):
            raise BagError("two topics are remapped to the same one; each sensor needs its own")
        reasons = {topic: self._unusable(topic, s.message_type) for topic, s in wished.items()}
        self.missing = [reason for reason in reasons.values() if reason is not None]
        self._sensors = {t: sensor for t, sensor in wished.items() if reasons[t] is None}
        if not self._sensors:
            recorded = ", ".join(sorted(bag.topics)) or "none"
            raise BagError(
                f"{bag.path} has no topic to replay ({'; '.join(self.missing)}); its topics: {recorded}"
            )
        self._clock_topic = remaps.get(CLOCK, CLOCK)
        self.time_source = self._resolved(time_source)
        self.counts = {topic: Count() for topic in self._sensors}
        self._timer = RosTimer() if self.time_source is TimeSource.SIM else FullSeconds()
        self._other_clock: str | None = None
        self._types = {t: sensor.message_type for t, sensor in self._sensors.items()}
        if self.time_source is TimeSource.SIM:
            self._types[self._clock_topic] = CLOCK_TYPE
            self.counts[self._clock_topic] = Count()
        self._store = get_typestore(Stores.LATEST)

    @property
    def notes(self) -> list[str]:
        """What was odd about time so far; a line each."""
        notes = [*([self._other_clock] if self._other_clock else []), *self._timer.jumps]
        more = len(notes) - MOST_NOTES
        return [*notes[:MOST_NOTES], f"{more} more jumps of time"] if more > 0 else notes

    def rows(self) -> Iterator[MetricsRow]:
        """Play everything; yields each row when it is due."""
        for message in self._bag.messages(self._types):
            parsed = self._parsed(message)
            now = self._time(message, parsed)
            if now is not None:
                yield from map(self.metrics.row, self._timer.due(now))
            if parsed is not None:
                self._take(message.topic, parsed)
        yield from map(self.metrics.row, self._timer.rest())

    def _parsed(self, message: Message) -> Any | None:  # noqa: ANN401
        """The message as an object; None if nobody wants it or it is not readable."""
        message_type = self._types.get(message.topic)
        if message_type is None:
            return None
        try:
            return self._store.deserialize_cdr(message.data, message_type)
        except (SerdeError, IndexError, AssertionError, MemoryError):
            self.counts[message.topic].unreadable += 1
            return None

    def _time(self, message: Message, parsed: Any | None) -> int | None:  # noqa: ANN401
        """The time that a message tells [ns]; None if it tells none."""
        if self.time_source is TimeSource.SIM:
            return _nanoseconds(parsed.clock) if parsed and message.topic == self._clock_topic else None
        stamp = 0 if parsed is None else _nanoseconds(parsed.header.stamp)  # 0: never set
        if self.time_source is TimeSource.HEADER:
            return stamp or None
        if stamp and self._other_clock is None and abs(stamp - message.time_ns) > OTHER_CLOCK:
            self._other_clock = (
                f"header stamps ({stamp / NANOSECONDS:.2f} s) are of another clock than the recorded "
                f"time ({message.time_ns / NANOSECONDS:.2f} s); --time header follows them"
            )
        return message.time_ns

    def _take(self, topic: str, parsed: Any) -> None:  # noqa: ANN401
        count = self.counts[topic]
        if topic not in self._sensors or self._sensors[topic].take(self.metrics, parsed):
            count.used += 1
        else:
            count.rejected += 1

    def _unusable(self, topic: str, message_type: str) -> str | None:
        """Why a topic cannot be used; None if it can."""
        recorded = self._bag.topics.get(topic)
        if recorded is None:
            return f"{topic} is missing"
        if _full_name(recorded) != message_type:
            return f"{topic} is {recorded}, not {message_type}"
        return None

    def _resolved(self, wish: TimeSource) -> TimeSource:
        no_clock = self._unusable(self._clock_topic, CLOCK_TYPE)
        if wish is TimeSource.AUTO:
            return TimeSource.RECORDED if no_clock else TimeSource.SIM
        if wish is TimeSource.SIM and no_clock:
            raise BagError(f"--time sim needs /clock, but {no_clock}; choose recorded or header")
        return wish


def _full_name(message_type: str) -> str:
    """The type with its /msg/, which older recorders leave out."""
    package, _, name = message_type.rpartition("/")
    return message_type if "/" in package or not package else f"{package}/msg/{name}"


def _jump(before_ns: int, after_ns: int) -> str:
    return f"time jumps from {before_ns / NANOSECONDS:.2f} s to {after_ns / NANOSECONDS:.2f} s"


def _nanoseconds(stamp: Any) -> int:  # noqa: ANN401
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)
