"""The ROS node `harness`: publishes an episode's samples as RoboTerrain's Gazebo bridge would.

It counts what it publishes per topic and listens to /cmd_vel. Topic names are relative, so remapping
and namespaces work; in the root namespace they are those of the README's table.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock

from harness import samples
from harness.robots import RoverSpec
from harness.ros import messages
from harness.sensors import table
from harness.sensors.lidar_spec import LidarSpec


@dataclass(slots=True)
class Channel:
    """One topic.

    Attributes:
        publisher: Of the topic.
        fill: Makes a message of a sample.
        topic: The resolved name, which a publisher forgets at shutdown.
        published: How many messages have been.
        record: Takes each message and returns the bytes to publish for it; None while nobody records.
    """

    publisher: Publisher
    fill: messages.Fill
    topic: str
    published: int = 0
    record: Callable[[messages.Message], bytes] | None = None

    def publish(self, sample: Any) -> None:  # noqa: ANN401 - the kind of sample that `fill` takes
        """Sends one sample."""
        message = self.fill(sample)
        self.publisher.publish(message if self.record is None else self.record(message))
        self.published += 1


class Bridge(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """Publishes ticks; hands /cmd_vel to `on_command`.

    Args:
        rover: Gives the frames.
        lidar: Gives the geometry of scans.
        context: Of rclpy.
        on_command: Takes each command.

    Attributes:
        channels_of: The topics of each kind of sample, in publishing order.
        clock_channel: /clock.
    """

    def __init__(
        self,
        rover: RoverSpec,
        lidar: LidarSpec,
        *,
        context: Context | None = None,
        on_command: Callable[[samples.Twist], None] | None = None,
    ) -> None:
        super().__init__("harness", context=context)
        self.channels_of = {
            row.sample: [
                self._channel(
                    messages.message_class(topic),
                    topic.name,
                    messages.filler(row, topic, rover, lidar),
                    best_effort=topic.best_effort,
                )
                for topic in row.topics
            ]
            for row in table.SENSORS
        }
        # Reliable serves best-effort listeners (rclpy's own) and reliable ones alike.
        self.clock_channel = self._channel(Clock, "/clock", messages.clock())
        self._on_command = on_command
        self._commands = self.create_subscription(
            Twist, "cmd_vel", self._receive, _qos(best_effort=False)
        )

    def _channel(
        self, kind: type, name: str, fill: messages.Fill, *, best_effort: bool = False
    ) -> Channel:
        publisher = self.create_publisher(kind, name, _qos(best_effort=best_effort))
        return Channel(publisher, fill, publisher.topic_name)

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Returns every topic, in publishing order; /clock is the last."""
        return (*chain.from_iterable(self.channels_of.values()), self.clock_channel)

    def publish_samples(self, tick: samples.Tick) -> None:
        """Publishes a tick's samples; its clock goes out with `publish_clock`, after them."""
        for sample in tick.samples:
            for channel in self.channels_of[type(sample)]:
                channel.publish(sample)

    def publish_clock(self, tick: samples.Tick) -> None:
        """Lets simulation time reach the tick's stamp."""
        self.clock_channel.publish(tick.stamp_ns)

    def published(self) -> dict[str, int]:
        """Returns the messages published so far, by resolved topic name."""
        return {channel.topic: channel.published for channel in self.channels}

    def _receive(self, message: Twist) -> None:
        linear, angular = message.linear.x, message.angular.z
        if not (math.isfinite(linear) and math.isfinite(angular)):
            self.get_logger().warning(
                f"ignored a non-finite command on {self._commands.topic_name}: "
                f"linear.x = {linear}, angular.z = {angular}",
                throttle_duration_sec=1.0,
            )
        elif self._on_command is not None:
            self._on_command(samples.Twist(linear, angular))


def _qos(*, best_effort: bool) -> QoSProfile:
    return QoSProfile(
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.VOLATILE,
        history=HistoryPolicy.KEEP_LAST,
        depth=10,
    )
