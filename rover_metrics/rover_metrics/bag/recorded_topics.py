"""What a replay takes from which topic of a recording."""

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.extended.messages import MessageIntake

CLOCK, CLOCK_TYPE = "/clock", "rosgraph_msgs/msg/Clock"

Message = Any  # rosbags makes the types


class Sink(NamedTuple):
    """Where messages go: to the metrics, then to the extended ones, if there are any."""

    metrics: TraversalMetrics
    extended: MessageIntake | None = None


class Source(NamedTuple):
    """A topic's message type, and how a message is taken.

    `take` gives False for a message that is left out because it is empty, not finite or impossible.
    """

    message_type: str
    take: Callable[[Sink, Message], bool]


def _take_scan(sink: Sink, scan: Message) -> bool:
    used = sink.metrics.add_scan(scan.ranges)
    if sink.extended is not None:
        sink.extended.scan(scan, used=used)
    return True  # a scan without a finite range is open space, not a fault


def _take_imu(sink: Sink, imu: Message) -> bool:
    a, w = imu.linear_acceleration, imu.angular_velocity
    used = sink.metrics.add_imu((a.x, a.y, a.z), (w.x, w.y, w.z))
    if sink.extended is not None:
        sink.extended.imu(imu, used=used)
    return used


def _take_pose(sink: Sink, poses: Message) -> bool:
    p = poses.poses[0].position if poses.poses else None
    used = p is not None and sink.metrics.add_pose((p.x, p.y, p.z))
    if sink.extended is not None:
        sink.extended.pose(poses, used=used)
    return used


def _take_odometry(sink: Sink, odometry: Message) -> bool:
    v = odometry.twist.twist.linear
    used = sink.metrics.add_odometry((v.x, v.y, v.z))
    if sink.extended is not None:
        sink.extended.odometry(odometry, used=used)
    return used


def _truth(take: Callable[[MessageIntake, Message], bool]) -> Callable[[Sink, Message], bool]:
    return lambda sink, message: sink.extended is not None and take(sink.extended, message)


SENSORS: Mapping[str, Source] = {
    "/scan": Source("sensor_msgs/msg/LaserScan", _take_scan),
    "/imu/data": Source("sensor_msgs/msg/Imu", _take_imu),
    "/rover/pose_array": Source("geometry_msgs/msg/PoseArray", _take_pose),
    "/odometry/wheels": Source("nav_msgs/msg/Odometry", _take_odometry),
}
# What only simulators publish, for the extended columns.
TRUTH: Mapping[str, Source] = {
    "/odom_ground_truth": Source("nav_msgs/msg/Odometry", _truth(MessageIntake.ground_truth)),
    "/rover/truth/contact": Source("std_msgs/msg/Bool", _truth(MessageIntake.contact)),
    "/rover/truth/traversal": Source("std_msgs/msg/Float64MultiArray", _truth(MessageIntake.traversal)),
}
