"""The ROS node `harness`: publishes samples as RoboTerrain's Gazebo bridge would, in lock-step.

It counts what it publishes per topic and listens to /cmd_vel. Topic names are relative, so remapping
and namespaces work; in the root namespace they are those of the README's table.

Lock-step: simulation time does not advance past a message that a listener has not handled. For each
tick the samples go out and are handled, then /clock goes out and is handled with the timers that it
triggers.
"""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any, Protocol

from geometry_msgs.msg import Twist
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock

from harness import samples
from harness.errors import UsageError
from harness.robots import RoverSpec
from harness.ros import messages
from harness.sensors import table
from harness.sensors.lidar_spec import LidarSpec
from rover_metrics.ros.parameters import BEST_EFFORT, RELIABLE
from rover_metrics.ros.subscriptions import keep_last

CLOCK = table.Topic("/clock", "rosgraph_msgs/msg/Clock")
SECOND_PUBLISHER = (
    "has a second publisher: what it sends would be logged as this run's; "
    "give each run a ROS_DOMAIN_ID of its own (0 to 101), or names and a clock of its own: "
    "--namespace NAME --ros-args -r /clock:=/NAME/clock"
)


class Listener(Protocol):
    """Somebody who must have handled everything before time goes on."""

    def wait_for_samples(self) -> None:
        """Returns when every published sample has been handled."""
        ...

    def wait_for_clock(self, stamp_ns: int) -> None:
        """Returns when the time has been taken over and its timers have run."""
        ...


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
    """Publishes ticks.

    Args:
        rover: Gives the frames.
        lidar: Gives the geometry of scans.
        context: Of rclpy.
        on_command: Takes each command of /cmd_vel.

    Attributes:
        channels_of: The topics of each kind of sample, in publishing order.
        clock_channel: /clock.
        time_ns: Simulation time of the tick that goes out now, whatever a fault tells of it.
        commands: The subscription to /cmd_vel.
        record_command: Takes each message of it; None while nobody records.
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
        self.time_ns = 0
        self.channels_of = {
            row.sample: [
                self._channel(topic, messages.filler(row, topic, rover, lidar)) for topic in row.topics
            ]
            for row in table.SENSORS
        }
        # Reliable serves best-effort listeners (rclpy's own) and reliable ones alike.
        self.clock_channel = self._channel(CLOCK, messages.by_names(Clock(), samples.Tick))
        self._on_command = on_command
        self.commands = self.create_subscription(Twist, "cmd_vel", self._receive, keep_last(10))
        self.record_command: Callable[[messages.Message], bytes] | None = None

    def _channel(self, topic: table.Topic, fill: messages.Fill) -> Channel:
        qos = keep_last(10, BEST_EFFORT if topic.best_effort else RELIABLE)
        publisher = self.create_publisher(messages.message_class(topic), topic.name, qos)
        return Channel(publisher, fill, publisher.topic_name)

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Returns every topic, in publishing order; /clock is the last."""
        return (*chain.from_iterable(self.channels_of.values()), self.clock_channel)

    def advance(self, tick: samples.Tick, sent: samples.Tick, *, listeners: Sequence[Listener]) -> None:
        """Publishes one tick; returns when all listeners have handled it.

        Args:
            tick: Of the episode.
            sent: What faults have left of it.
            listeners: Are waited for.
        """
        self.time_ns = tick.stamp_ns
        for burst in _bursts(sent.samples):
            for sample in burst:
                for channel in self.channels_of[type(sample)]:
                    channel.publish(sample)
            for listener in listeners:
                listener.wait_for_samples()
        if sent.tells_time:
            self.clock_channel.publish(sent)
            for listener in listeners:
                listener.wait_for_clock(sent.stamp_ns)
        if not listeners:
            self.executor.spin_once(timeout_sec=0.0)  # /cmd_vel and parameter services

    def published(self) -> dict[str, int]:
        """Returns the messages published so far, by resolved topic name."""
        return {channel.topic: channel.published for channel in self.channels}

    def stop_recording(self) -> None:
        """Lets messages go out as they are, again."""
        self.record_command = None
        for channel in self.channels:
            channel.record = None

    def refuse_other_publishers(self, topics: Iterable[str]) -> None:
        """Another harness or simulator would mix into the log; what starts later is caught in lock-step.

        Raises:
            UsageError: One of these topics, or /clock, has a second publisher.
        """
        for topic in (*topics, self.clock_channel.topic):
            if self.count_publishers(topic) > 1:
                raise UsageError(f"{topic} {SECOND_PUBLISHER}")

    def _receive(self, message: Twist) -> None:
        if self.record_command is not None:
            self.record_command(message)
        linear, angular = message.linear.x, message.angular.z
        if not (math.isfinite(linear) and math.isfinite(angular)):
            self.get_logger().warning(
                f"ignored a non-finite command on {self.commands.topic_name}: "
                f"linear.x = {linear}, angular.z = {angular}",
                throttle_duration_sec=1.0,
            )
        elif self._on_command is not None:
            self._on_command(samples.Twist(linear, angular))


def _bursts(sent: Iterable[samples.Sample]) -> list[list[samples.Sample]]:
    """Parts with at most one sample of a kind: a listener's queue may hold only the latest message."""
    bursts: list[list[samples.Sample]] = []
    before: Counter[type[samples.Sample]] = Counter()
    for sample in sent:
        if before[type(sample)] == len(bursts):
            bursts.append([])
        bursts[before[type(sample)]].append(sample)
        before[type(sample)] += 1
    return bursts
