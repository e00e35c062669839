"""Plays a recording into the metrics: messages in recorded order, a row at each full second.

A row is due when the chosen time reaches a full second, and holds every message up to and including
that instant. With simulated time /clock moves the same timer as in the live node; with recorded or
header time a second is full when a message comes from after it, or at the end. A recording of
harness.run thus gives the rows of the live run in each of the three ways.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any

from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from rover_metrics.bag.bag_reader import Bag
from rover_metrics.bag.mcap_stream import BagError, Message
from rover_metrics.bag.oddities import Oddities
from rover_metrics.core.columns import Row
from rover_metrics.session import MetricsSession
from rover_metrics.timing import NANOSECONDS, ClockRows, FullSeconds, TimeSource, age
from rover_metrics.topics import CLOCK, SENSORS, Source, is_time, nanoseconds, sources_of, stamp_ns

MOST_NOTES = 5
MAKERS = {  # by what is missing: of what type which node of others makes it
    "sensor_msgs/msg/LaserScan": ("sensor_msgs/msg/PointCloud2", "pointcloud_to_laserscan"),
    "geometry_msgs/msg/PoseArray": ("sensor_msgs/msg/NavSatFix", "robot_localization"),
}


@dataclass
class Count:
    """Messages of one topic: used, left out as the node would, and not readable."""

    used: int = 0
    rejected: int = 0
    unreadable: int = 0


class Playback:
    """One pass through a recording.

    Args:
        bag: The recording.
        session: Takes the samples and makes the rows.
        remaps: Recorded topic by the topic that the metrics node listens to, both absolute.
        time_source: Which time the rows follow.

    Attributes:
        time_source: The one in use, never AUTO.
        counts: Messages by recorded topic, of the topics in use.
        missing: Why a topic is not in use; a line each.
    """

    def __init__(
        self,
        bag: Bag,
        session: MetricsSession,
        remaps: Mapping[str, str] = MappingProxyType({}),
        time_source: TimeSource = TimeSource.AUTO,
    ) -> None:
        self._bag, self._session, self.metrics = bag, session, session.metrics
        self._sources, self.missing = self._there(SENSORS, remaps)
        if not self._sources:
            recorded = ", ".join(sorted(bag.topics)) or "none"
            raise BagError(
                f"{bag.path} has no topic to replay ({'; '.join(self.missing)}); its topics: {recorded}"
            )
        further, _ = self._there(sources_of(session)[len(SENSORS) :], remaps)  # a real rover has none
        self._sources |= further
        clock, no_clock = self._there([CLOCK], remaps)
        self.time_source = _resolved(time_source, no_clock)
        if self.time_source is TimeSource.SIM:
            self._sources |= clock
        self.counts = {topic: Count() for topic in self._sources}
        self._timer = ClockRows() if self.time_source is TimeSource.SIM else FullSeconds()
        self._other_clock: list[str] = []  # a line at most
        self._oddities = Oddities()

    @property
    def notes(self) -> list[str]:
        """What was odd about time and samples so far; a line each."""
        notes = [*self._other_clock, *self._timer.jumps]
        more = len(notes) - MOST_NOTES
        notes = [*notes[:MOST_NOTES], f"{more} more jumps of time"] if more > 0 else notes
        return notes + self._oddities.notes(self.metrics)

    def rows(self) -> Iterator[Row]:
        """Plays everything; yields each row when it is due."""
        for message in self._bag.messages(self._sources):
            parsed = self._parsed(message)
            now = self._time(message, parsed)
            if now is not None:
                for at_ns in self._timer.due(now):
                    yield self._session.row(at_ns)
            if parsed is not None:
                self._take(message, parsed)
        for at_ns in self._timer.rest():
            yield self._session.row(at_ns)

    def _parsed(self, message: Message) -> Any | None:  # noqa: ANN401
        if message.topic not in self._sources:
            return None
        parsed = deserialised(message.data, self._bag.topics[message.topic])
        self.counts[message.topic].unreadable += parsed is None
        return parsed

    def _time(self, message: Message, parsed: Any | None) -> int | None:  # noqa: ANN401
        if self.time_source is TimeSource.SIM:
            clock = getattr(parsed, "clock", None)
            return nanoseconds(clock) if clock is not None and is_time(clock) else None
        stamp = stamp_ns(parsed) if hasattr(parsed, "header") else 0  # 0: never set
        if self.time_source is TimeSource.HEADER:
            return stamp or None
        if stamp and not self._other_clock and age(message.time_ns, stamp) is None:
            self._other_clock.append(
                f"header stamps ({stamp / NANOSECONDS:.2f} s) are of another clock than the recorded "
                f"time ({message.time_ns / NANOSECONDS:.2f} s); --time header follows them"
            )
        return message.time_ns

    def _take(self, message: Message, parsed: Any) -> None:  # noqa: ANN401
        count, is_used = self.counts[message.topic], False
        if hasattr(parsed, "header"):
            self._oddities.stamped(message.topic, stamp_ns(parsed))
        for source in self._sources[message.topic]:
            remark = source.take(self._session, parsed, stamp_ns(parsed) if source.has_stamp else 0)
            self._oddities.add(source, message.topic, parsed, remark)
            is_used |= remark is None or not remark.left_out
        count.used += is_used
        count.rejected += not is_used

    def _there(
        self, sources: Iterable[Source], remaps: Mapping[str, str]
    ) -> tuple[dict[str, list[Source]], list[str]]:
        """The sources that can be used, by recorded topic, and why the others cannot."""
        wished = [(remaps.get(source.name, source.name), source) for source in sources]
        there, reasons = dict[str, list[Source]](), []
        for topic, source in wished:
            recorded, types = self._bag.topics.get(topic), (source.message_type, *source.also)
            if recorded is None:
                others = self._bag.topics.keys() - dict(wished).keys()
                alike = sorted(name for name in others if self._bag.topics[name] in types)
                if alike:
                    hint = f" ({', '.join(alike[:MOST_NOTES])} would do)"
                else:
                    kind, maker = MAKERS.get(source.message_type, ("", ""))
                    made_of = sorted(name for name in others if self._bag.topics[name] == kind)
                    hint = f" ({maker} makes one of {made_of[0]})" if made_of else ""
                reasons.append(f"{topic} is missing{hint}")
            elif recorded not in types:
                reasons.append(f"{topic} is {recorded}, not {source.message_type}")
            else:
                there.setdefault(topic, []).append(source)
        return there, reasons


@cache  # each one compiles anew what reads a type
def _typestore() -> Typestore:
    return get_typestore(Stores.LATEST)


def deserialised(data: bytes, message_type: str) -> Any | None:  # noqa: ANN401
    """Returns a message as rosbags has it; None if the bytes are of none of this type.

    Args:
        data: The message in CDR.
        message_type: As "nav_msgs/msg/Odometry".
    """
    try:
        return _typestore().deserialize_cdr(data, message_type)
    except (SerdeError, IndexError, AssertionError, MemoryError):
        return None


def _resolved(wish: TimeSource, no_clock: Sequence[str]) -> TimeSource:
    if wish is TimeSource.AUTO:
        return TimeSource.RECORDED if no_clock else TimeSource.SIM
    if wish is TimeSource.SIM and no_clock:
        raise BagError(f"--time sim needs /clock, but {no_clock[0]}; choose recorded or header")
    return wish
