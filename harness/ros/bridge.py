"""The ROS node `harness`: publishes an episode's samples as RoboTerrain's Gazebo bridge would.

It counts what it publishes per topic and listens to /cmd_vel. Topic names are relative, so remapping
and namespaces work; in the root namespace they are those of the README's table.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from typing import Any

from geometry_msgs.msg import PoseArray, Twist
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from std_msgs.msg import Bool, Float64MultiArray

from harness import samples
from harness.robots import RoverSpec
from harness.ros import messages
from harness.sensors.lidar_spec import LidarSpec

RELIABLE = QoSProfile(
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
)
BEST_EFFORT = QoSProfile(
    reliability=ReliabilityPolicy.BEST_EFFORT,
    durability=DurabilityPolicy.VOLATILE,
    history=HistoryPolicy.KEEP_LAST,
    depth=10,
)


@dataclass(slots=True)
class Channel:
    """One topic: its resolved name, how a sample becomes its message, how many have been published."""

    publisher: Publisher
    fill: messages.Fill
    topic: str
    published: int = 0

    def publish(self, sample: Any) -> None:  # noqa: ANN401 - the kind of sample that `fill` takes
        """Sends one sample."""
        self.publisher.publish(self.fill(sample))
        self.published += 1


class Bridge(Node):  # type: ignore[misc]  # rclpy has no types for mypy
    """Publishes ticks; hands /cmd_vel to `on_command`.

    Attributes:
        of: The topics of each kind of sample, in publishing order.
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
        channel = self._channel
        self.of: dict[type, tuple[Channel, ...]] = {
            samples.LaserScan: (channel(LaserScan, "scan", messages.laser_scan(lidar)),),
            samples.Imu: (channel(Imu, "imu/data", messages.imu(rover)),),
            samples.Pose: (channel(PoseArray, "rover/pose_array", messages.pose_array(), BEST_EFFORT),),
            samples.Odometry: (channel(Odometry, "odometry/wheels", messages.wheel_odometry(rover)),),
            samples.GroundTruth: (channel(Odometry, "odom_ground_truth", messages.ground_truth()),),
            samples.JointStates: (channel(JointState, "joint_states", messages.joint_states(rover)),),
            samples.TruthState: (
                channel(Bool, "rover/truth/contact", messages.contact()),
                channel(Float64MultiArray, "rover/truth/traversal", messages.traversal()),
            ),
        }
        # Reliable serves best-effort listeners (rclpy's own) and reliable ones alike.
        self.clock_channel = self._channel(Clock, "/clock", messages.clock())
        self._on_command = on_command
        self._commands = self.create_subscription(Twist, "cmd_vel", self._receive, RELIABLE)

    def _channel(
        self, kind: type, topic: str, fill: messages.Fill, qos: QoSProfile = RELIABLE
    ) -> Channel:
        publisher = self.create_publisher(kind, topic, qos)
        return Channel(publisher, fill, publisher.topic_name)  # a publisher forgets at shutdown

    @property
    def channels(self) -> tuple[Channel, ...]:
        """Every topic, in publishing order; /clock is the last."""
        return (*chain.from_iterable(self.of.values()), self.clock_channel)

    def publish_samples(self, tick: samples.Tick) -> None:
        """Publishes a tick's samples; its clock goes out with `publish_clock`, after them."""
        for sample in tick.samples:
            for channel in self.of[type(sample)]:
                channel.publish(sample)

    def publish_clock(self, tick: samples.Tick) -> None:
        """Lets simulation time reach the tick's stamp."""
        self.clock_channel.publish(tick.stamp_ns)

    def published(self) -> dict[str, int]:
        """Messages published so far, by resolved topic name."""
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
