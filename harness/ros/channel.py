"""One topic of the bridge: its publisher, what makes its messages, and how many there were.

A message that nobody would get is counted, but not made: a writer keeps none for who listens later,
unless the topic is latched.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rclpy.node import Node
from rclpy.publisher import Publisher

from harness.base.errors import SOURCE_IT, UsageError
from harness.messages.refilled import Fill
from harness.ros.foreign_type import forget_missing_definition, message_type
from harness.sensors.table import Topic
from rover_metrics.ros.parameters import BEST_EFFORT, RELIABLE
from rover_metrics.ros.subscriptions import keep_last

Message = Any  # rclpy's classes have no types, and some messages are bytes


@dataclass(slots=True)
class Channel:
    """One topic.

    Attributes:
        publisher: Of the topic.
        send: Publishes bytes by it; rclpy's own `publish` looks at their kind each time.
        listeners: Returns how many subscriptions DDS has matched to it.
        fill: Makes a message of a sample.
        topic: The resolved name, which a publisher forgets at shutdown.
        published: How many messages have been, whether or not anybody listened.
        size: Of the last one that was made [bytes].
        record: Takes each message and returns the bytes to publish for it; None while nobody records.
        is_wanted: Returns whether anybody but listeners wants messages.
        latched: Whether a subscription that is matched later gets the last messages.
        on_demand: Whether only those messages count that somebody gets.
    """

    publisher: Publisher
    send: Callable[[bytes], object]
    listeners: Callable[[], int]
    fill: Fill
    topic: str
    published: int = 0
    size: int = 0
    record: Callable[[Message], bytes] | None = None
    is_wanted: Callable[[], bool] = bool
    latched: bool = False
    on_demand: bool = False

    def publish(self, sample: Any) -> None:  # noqa: ANN401 - the kind of sample that `fill` takes
        """Sends one sample, if somebody gets it and there is a message of it."""
        if not (self.listeners() or self.latched or self.is_wanted()):
            self.published += not self.on_demand
            return
        message = self.fill(sample)
        if message is None:
            return
        data = message if self.record is None else self.record(message)
        self.send(data)
        self.published += 1
        self.size = len(data)


def open_channel(node: Node, topic: Topic, fill: Fill) -> Channel:
    """Returns a new topic of a node.

    Args:
        node: Publishes it.
        topic: Its name, type and QoS.
        fill: Makes a message of a sample, or None.

    Raises:
        UsageError: Its type is not to be had.
    """
    kind = message_type(topic.message_type)
    if kind is None:
        raise UsageError(
            f"/{topic.name} needs {topic.message_type}, which is not installed; {SOURCE_IT}"
        )
    reliability = BEST_EFFORT if topic.best_effort else RELIABLE
    qos = keep_last(topic.depth, reliability, latched=topic.latched)
    publisher = node.create_publisher(kind, topic.name, qos)
    forget_missing_definition()
    handle = publisher.handle  # whose methods are not wrapped
    return Channel(
        publisher,
        handle.publish_raw,
        handle.get_subscription_count,
        fill,
        publisher.topic_name,
        latched=topic.latched,
        on_demand=topic.on_demand,
    )
