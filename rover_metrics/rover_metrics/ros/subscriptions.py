"""Subscriptions whose middleware events are reported; QoS with every policy named."""

from collections.abc import Callable
from functools import partial
from pkgutil import resolve_name
from typing import Any

from rclpy.node import Node
from rclpy.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    QoSProfile,
    ReliabilityPolicy,
    qos_policy_name_from_kind,
)
from rclpy.subscription import Subscription

from rover_metrics.health.reception import LOST, NOT_HEARD
from rover_metrics.ros.decoding import READERS, decoded
from rover_metrics.ros.parameters import BEST_EFFORT, RELIABLE, declare_reliability
from rover_metrics.topics import ENERGY, SENSORS, TRUTH, Source

try:
    from rclpy.event_handler import SubscriptionEventCallbacks, UnsupportedEventTypeError
except ImportError:  # Humble
    from rclpy.qos_event import SubscriptionEventCallbacks, UnsupportedEventTypeError


# With this module, so that a package that is not installed is reported as the rest of ROS is.
_MESSAGES = {
    source.message_type: resolve_name(source.message_type.replace("/msg/", ".msg:"))
    for source in (*SENSORS, *TRUTH, *ENERGY)
}


QUEUE = 10  # messages that wait


def keep_last(depth: int, reliability: str = RELIABLE, *, latched: bool = False) -> QoSProfile:
    """Returns the QoS of a topic.

    Args:
        depth: How many messages may wait.
        reliability: RELIABLE or BEST_EFFORT.
        latched: Whether late subscribers get the last ones too (transient local); else volatile.
    """
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST,
        depth=depth,
        reliability=ReliabilityPolicy[reliability.upper()],
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


class Listening:
    """A topic that a metrics_node listens to; its account in the node's reception is opened.

    Args:
        node: Takes each message, and counts those that were lost and publishers that are not heard.
        source: The topic. Its name is relative to the node's namespace; its reliability is what the
            standard ROS parameter says, if it is set.

    Attributes:
        topic: The resolved name.
    """

    def __init__(self, node: Node, source: Source) -> None:
        self._node, self._name = node, source.name.lstrip("/")
        reception, take = node.reception, partial(node.take, source)
        self.topic: str = node.resolve_topic_name(self._name)
        wished = BEST_EFFORT if source.best_effort else RELIABLE
        parameter, reliability = declare_reliability(node, self.topic, wished)
        reception.listen(self.topic, may_be_missing=source not in SENSORS)
        queue = node.settings.pose_queue if source.best_effort else QUEUE  # poses are
        self._qos = keep_last(queue, reliability)
        self._type = kind = _MESSAGES[source.message_type]

        def hear(data: bytes) -> None:
            take(decoded(source.message_type, kind, data))

        self._is_raw = source.message_type in READERS
        self._handler = hear if self._is_raw else take
        self._events = SubscriptionEventCallbacks(
            incompatible_qos=lambda event: reception.remark(
                self.topic, NOT_HEARD, detail=_mend(event, reliability, parameter)
            ),
            message_lost=lambda event: reception.remark(self.topic, LOST, event.total_count_change),
        )
        self._subscription = self._subscribe(self._qos)

    def hold(self, messages: int) -> None:
        """Listens anew, with a queue of so many messages; 0 for the first one, unless it is in use."""
        qos = keep_last(messages or self._qos.depth, self._qos.reliability.name)
        if messages or self._subscription.qos_profile.depth != qos.depth:
            former, self._subscription = self._subscription, self._subscribe(qos)
            self._node.destroy_subscription(former)

    def _subscribe(self, qos: QoSProfile) -> Subscription:
        subscribe = partial(self._node.create_subscription, self._type, self._name, self._handler, qos)
        try:
            return subscribe(raw=self._is_raw, event_callbacks=self._events)
        except UnsupportedEventTypeError:  # a middleware that does not report losses
            return subscribe(raw=self._is_raw)


def taker(subscription: Subscription) -> Callable[[int | None], None]:
    """Returns what handles the messages that have come for a subscription to bytes: so many, or all.

    An executor takes three times as long, and a look that finds nothing half as long as a message.
    """
    take, kind, handle = subscription.handle.take_message, subscription.msg_type, subscription.callback

    def handle_waiting(most: int | None) -> None:
        while most != 0 and (taken := take(kind, True)) is not None:  # with what is known of its way
            handle(taken[0])
            most = None if most is None else most - 1

    return handle_waiting


# The class of the event has another name in each distribution.
def _mend(event: Any, reliability: str, parameter: str) -> str:  # noqa: ANN401
    policy = qos_policy_name_from_kind(event.last_policy_kind)
    if policy == "RELIABILITY":
        return (
            f": it is best effort and this node asks for {reliability}; make the publisher reliable, "
            f"or start this node with -p {parameter}:={BEST_EFFORT}"
        )
    return f": its {policy.lower()} does not fit; this node asks for {reliability}, volatile"
