"""Hands on what a run's nodes publish and hear, as bytes: to a recording, to Foxglove.

What the bridge and the hosted metrics_node publish, and the commands that the bridge hears. It stands
before the publishers, so sinks get exactly the published bytes and no subscriber has to be waited for.
"""

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from rclpy.publisher import Publisher
from rclpy.serialization import serialize_message
from rclpy.subscription import Subscription

from harness.base.message_types import typestore
from harness.messages.sink import Endpoint, Intake, Sink
from harness.ros.bridge import Bridge
from harness.ros.channel import Channel, Message
from rover_metrics.ros.metrics_publisher import MetricsPublisher

Record = Callable[[Message], bytes]


class Tap:
    """Taps the nodes of one run.

    Args:
        sinks: Get the messages.
    """

    def __init__(self, *sinks: Sink) -> None:
        self._sinks = sinks
        self._bridges: list[Bridge] = []

    def tap(
        self, bridge: Bridge, metrics: MetricsPublisher | None = None, others: Iterable[Channel] = ()
    ) -> None:
        """Hands on all that the bridge publishes and hears from now on, under the time of its tick.

        A message's own stamp may differ from that where a fault delays it or disturbs the clock.

        Args:
            bridge: A node of the run; of several, the first one tells the time.
            metrics: Of the hosted metrics_node, if there is one; it then publishes for nobody too.
            others: Topics of the run that are not the bridge's own.
        """
        self._bridges.append(bridge)
        for channel in (*bridge.channels, *others):
            intakes = self._opened(channel.topic, channel.publisher, is_foreign=False)
            channel.record = self._record(intakes)
            channel.is_wanted = partial(_is_wanted, intakes)
        bridge.commands.record(lambda topic, heard: self._record(self._opened(topic, heard)))
        if metrics is not None and metrics.publisher is not None:
            publisher = metrics.publisher
            opened = self._opened(publisher.topic_name, publisher, is_late=True)
            metrics.record = self._record(opened)

    def hear(self, topic: str, subscription: Subscription) -> Record | None:
        """Returns what hands on each message of a topic that is heard; None if nobody knows its type."""
        is_known = type_name(subscription.msg_type) in typestore().types
        return self._record(self._opened(topic, subscription)) if is_known else None

    def _opened(
        self,
        topic: str,
        node_end: Publisher | Subscription,
        *,
        is_foreign: bool = True,
        is_late: bool = False,
    ) -> list[Intake]:
        """What of each sink takes the messages of a topic."""
        qos = node_end.qos_profile
        policies = {name: int(getattr(qos, name)) for name in ("history", "reliability", "durability")}
        kind = type_name(node_end.msg_type)
        heard = Endpoint(topic, kind, qos.depth, **policies, is_foreign=is_foreign, is_late=is_late)
        return [sink.open(heard) for sink in self._sinks]

    def _record(self, intakes: Sequence[Intake]) -> Record:
        """What hands on messages and returns their bytes."""

        def record(message: Message) -> bytes:
            written = message if isinstance(message, bytes) else serialize_message(message)
            for intake in intakes:
                intake.take(self._bridges[0].time_ns, written)
            return written

        return record


def _is_wanted(intakes: Sequence[Intake]) -> bool:
    return any(intake.is_wanted() for intake in intakes)


def type_name(kind: type) -> str:
    """Returns the name of rclpy's class of a message, as in sensor_msgs/msg/LaserScan."""
    return f"{kind.__module__.split('.')[0]}/msg/{kind.__name__}"
