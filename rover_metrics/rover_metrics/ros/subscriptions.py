"""Subscriptions whose middleware events are reported; QoS with every policy named."""

from collections.abc import Callable
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

from rover_metrics.health.reception import LOST, NOT_HEARD, Reception
from rover_metrics.ros.decoding import READERS, decoded
from rover_metrics.ros.parameters import BEST_EFFORT, RELIABLE, declare_reliability
from rover_metrics.topics import ENERGY, SENSORS, TRUTH, Message, Source

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


def subscribe(
    node: Node,
    source: Source,
    callback: Callable[[Message], None],
    reception: Reception,
    *,
    pose_queue: int = 1,
) -> str:
    """Subscribes, opens the topic's account and returns the topic's resolved name.

    Args:
        node: Who subscribes.
        source: The topic. Its name is relative to the node's namespace; its reliability is what the
            standard ROS parameter says, if it is set.
        callback: Is given each message.
        reception: Counts messages that were lost and publishers that are not heard.
        pose_queue: How many messages of a topic that is best effort, as poses are, may wait.
    """
    name = source.name.lstrip("/")
    topic: str = node.resolve_topic_name(name)
    wished = BEST_EFFORT if source.best_effort else RELIABLE
    parameter, reliability = declare_reliability(node, topic, wished)
    qos = keep_last(pose_queue if source.best_effort else QUEUE, reliability)
    reception.listen(topic, may_be_missing=source.is_truth)
    message_type = _MESSAGES[source.message_type]
    is_raw = source.message_type in READERS

    def hear(data: bytes) -> None:
        callback(decoded(source.message_type, message_type, data))

    handler = hear if is_raw else callback
    events = SubscriptionEventCallbacks(
        incompatible_qos=lambda event: reception.remark(
            topic, NOT_HEARD, detail=_mend(event, reliability, parameter)
        ),
        message_lost=lambda event: reception.remark(topic, LOST, event.total_count_change),
    )
    try:
        node.create_subscription(message_type, name, handler, qos, raw=is_raw, event_callbacks=events)
    except UnsupportedEventTypeError:  # a middleware that does not report losses
        node.create_subscription(message_type, name, handler, qos, raw=is_raw)
    return topic


def take_all(subscription: Subscription) -> None:
    """Handles what has come for a subscription to bytes; an executor takes three times as long."""
    take, kind, handle = subscription.handle.take_message, subscription.msg_type, subscription.callback
    while (taken := take(kind, True)) is not None:  # with what is known of its way
        handle(taken[0])


# The class of the event has another name in each distribution.
def _mend(event: Any, reliability: str, parameter: str) -> str:  # noqa: ANN401
    policy = qos_policy_name_from_kind(event.last_policy_kind)
    if policy == "RELIABILITY":
        return (
            f": it is best effort and this node asks for {reliability}; make the publisher reliable, "
            f"or start this node with -p {parameter}:={BEST_EFFORT}"
        )
    return f": its {policy.lower()} does not fit; this node asks for {reliability}, volatile"
