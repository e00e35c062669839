"""Listens to the topics that a scenario expects something of, as soon as somebody publishes them."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

from rclpy.subscription import Subscription
from rosgraph_msgs.msg import Clock

from harness.base.errors import SOURCE_IT, UsageError
from harness.base.message_types import read_message
from harness.ros.bridge import Bridge
from harness.ros.commands import RCLError
from harness.ros.foreign_type import forget_missing_definition
from harness.ros.topic_monitor import PLUMBING, message_class, offered_quality
from harness.scenario.arrivals import Arrivals, readers
from harness.scenario.names import AGE, HeardQuantity, check_messages, heard_quantity
from harness.scenario.spec import Scenario

Record = Callable[[str, Subscription], Callable[[Any], object] | None]


class Subscriptions:
    """The topics of which something is expected, and what has arrived on them.

    Args:
        bridge: Subscribes.
        scenario: What it expects and measures of topics.
        now: Tells simulation time since the start, and that of the listeners' clock [ns].
        record: Returns what records the messages of a topic that the bridge does not publish itself.

    Attributes:
        heard: Of each topic that somebody has published.
    """

    def __init__(
        self, bridge: Bridge, scenario: Scenario, *, now: Callable[[], tuple[int, int]], record: Record
    ) -> None:
        self._bridge, self._now, self._record = bridge, now, record
        self._wanted: dict[str, list[HeardQuantity]] = {}
        for quantity in filter(None, map(heard_quantity, scenario.quantities)):
            self._wanted.setdefault(quantity.topic, []).append(quantity)
        # From whose stamps latencies count.
        self._inputs = {bound.of for _, bound in scenario.measured if bound.of is not None}
        self._readers = readers(scenario.quantities)
        self._missing = {*self._wanted, *self._inputs, *self._readers}
        self._problem: str | None = None
        self.heard: dict[str, Arrivals] = {}

    @property
    def known(self) -> list[str]:
        """Returns all topics that somebody publishes."""
        topics = [topic for topic, _ in self._bridge.get_topic_names_and_types()]
        return [t for t in topics if t not in PLUMBING and self._bridge.count_publishers(t)]

    def look_around(self) -> bool:
        """Listens to topics that have turned up; returns whether there were any.

        Raises:
            UsageError: Messages of a topic cannot be heard, or have not what is expected of them.
        """
        if self._problem is not None:
            raise UsageError(self._problem)
        before = len(self._missing)
        for topic in sorted(self._missing):
            publishers = self._bridge.get_publishers_info_by_topic(topic)
            if publishers:
                with suppress(RCLError):  # /cmd_vel is heard as another type, not for long
                    self._listen(topic, publishers)
                    self._missing.remove(topic)
        return len(self._missing) < before

    def _listen(self, topic: str, publishers: Sequence[Any]) -> None:
        name, wanted = publishers[0].topic_type, self._wanted.get(topic, ())
        kind = message_class(name)
        if kind is None:
            raise UsageError(f"{topic} is of the type {name}, which is not installed; {SOURCE_IT}")
        for quantity in wanted:
            if problem := check_messages(quantity, name):
                raise UsageError(problem)
        reader = self._readers.get(topic)
        if reader is not None and name not in reader.types:
            known = ", ".join(reader.types)
            raise UsageError(f"{topic} is of the type {name}; judged can be one of {known}")
        paths = sorted({q.path for q in wanted if q.path})
        arrivals = Arrivals(paths, read=None if reader is None else reader.read)
        # Their content counts only where something is expected of it, or of their stamps.
        is_read = topic in self._inputs or any(q.path or q.measure == AGE for q in wanted)
        is_read |= reader is not None
        is_made = not hasattr(kind, "get_fields_and_field_types")  # for bytes alone
        record: list[Callable[[Any], object]] = []
        take = partial(self._take, arrivals, record, name if is_read and is_made else None)
        raw = kind is not Clock and (is_made or not is_read)
        heard = self._bridge.create_subscription(kind, topic, take, offered_quality(publishers), raw=raw)
        forget_missing_definition()
        if topic not in (*self._bridge.published(), self._bridge.commands.topic):
            record += filter(None, [self._record(topic, heard)])
        self.heard[topic] = arrivals

    def _take(
        self,
        arrivals: Arrivals,
        record: Sequence[Callable[[Any], object]],
        made: str | None,
        message: Any,  # noqa: ANN401 - of any type
    ) -> None:
        for each in record:
            each(message)
        content = message if made is None else read_message(message, made)
        try:
            arrivals.take(content, *self._now())
        except (AttributeError, TypeError, ValueError) as error:  # of a type that rosbags does not know
            self._problem = f"{made or type(message).__name__} has no such field: {error}"
