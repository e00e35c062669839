"""The topics that the metrics are made of: names, types, and how a message becomes a sample.

Node and replay read this table; it needs nothing of ROS but the shape of its messages, which is the
same in rclpy and in rosbags.
"""

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any

from rover_metrics.core.rotation import Quaternion, Vector3
from rover_metrics.extended.traffic_columns import IMU, ODOMETRY, POSE, SCAN
from rover_metrics.health.rejections import NO_TIME
from rover_metrics.session import MetricsSession, Remark
from rover_metrics.timing import NANOSECONDS

UNKNOWN = -1.0  # first covariance of what a sensor does not give (sensor_msgs/Imu)

Message = Any  # neither rclpy's nor rosbags' classes have types


@dataclass(frozen=True, eq=False)
class Source:
    """One topic; `take` hands a message and its stamp [ns], 0 without one, to a session."""

    name: str  # as it is in the root namespace
    message_type: str  # in full, e.g. "sensor_msgs/msg/Imu"
    take: Callable[[MetricsSession, Message, int], Remark | None]
    _: KW_ONLY
    best_effort: bool = False  # only the newest message matters, so that old ones are not queued
    has_stamp: bool = True  # its messages have a header
    also: tuple[str, ...] = ()  # types that say the same, which recordings may have instead


def nanoseconds(time: Message) -> int:
    """Returns a builtin_interfaces/Time in nanoseconds."""
    return int(time.sec) * NANOSECONDS + int(time.nanosec)


def is_time(time: Message) -> bool:
    """Returns whether a builtin_interfaces/Time can be the time of a clock."""
    return bool(time.sec >= 0 and time.nanosec < NANOSECONDS)


def stamp_ns(message: Message) -> int:
    """Returns the stamp of a message's header [ns]."""
    return nanoseconds(message.header.stamp)


def vector(value: Message) -> Vector3:
    """Returns the coordinates of a geometry_msgs/Vector3 or Point."""
    return value.x, value.y, value.z


def quaternion(value: Message) -> Quaternion:
    """Returns a geometry_msgs/Quaternion as (x, y, z, w)."""
    return value.x, value.y, value.z, value.w


def _scan(session: MetricsSession, scan: Message, stamp_ns: int) -> Remark | None:
    return session.take_scan(
        stamp_ns,
        scan.ranges,
        angles=(scan.angle_min, scan.angle_increment),
        limits=(scan.range_min, scan.range_max),
    )


def _imu(session: MetricsSession, imu: Message, stamp_ns: int) -> Remark | None:
    acceleration, rate = vector(imu.linear_acceleration), vector(imu.angular_velocity)
    is_given = imu.orientation_covariance[0] != UNKNOWN
    orientation = quaternion(imu.orientation) if is_given else None
    return session.take_imu(stamp_ns, acceleration, rate, orientation)


def _pose(session: MetricsSession, message: Message, stamp_ns: int) -> Remark | None:
    pose = next(iter(getattr(message, "poses", ())), None) or getattr(message, "pose", None)
    pose = getattr(pose, "pose", pose)  # one with a covariance
    return session.take_pose(stamp_ns, None if pose is None else vector(pose.position))


def _traversal(session: MetricsSession, values: Message, _: int) -> Remark | None:
    label = values.layout.dim[0].label if values.layout.dim else ""
    return session.take_traversal(list(values.data), label.split(",") if label else None)


def _velocity(odometry: Message) -> Vector3:
    return vector(odometry.twist.twist.linear)


def sources_of(session: MetricsSession) -> tuple[Source, ...]:
    """Returns the topics that the columns of a session are made of."""
    if session.extended is None:
        return SENSORS
    return (*SENSORS, *TRUTH, *(() if session.extended.energy is None else ENERGY))


SENSORS = (
    Source(SCAN, "sensor_msgs/msg/LaserScan", _scan),
    Source(IMU, "sensor_msgs/msg/Imu", _imu),
    Source(
        POSE,
        "geometry_msgs/msg/PoseArray",
        _pose,
        best_effort=True,
        also=(
            "geometry_msgs/msg/PoseStamped",
            "geometry_msgs/msg/PoseWithCovarianceStamped",
            "nav_msgs/msg/Odometry",
        ),
    ),
    Source(
        ODOMETRY,
        "nav_msgs/msg/Odometry",
        lambda session, odometry, stamp_ns: session.take_odometry(stamp_ns, _velocity(odometry)),
    ),
)
# For the extended columns; many robots do not publish these, and they are not missed.
TRUTH = (
    Source(
        "/odom_ground_truth",
        "nav_msgs/msg/Odometry",
        lambda session, odometry, _: session.take_true_velocity(_velocity(odometry)),
    ),
    Source(
        "/rover/truth/contact",
        "std_msgs/msg/Bool",
        lambda session, contact, _: session.take_contact(touches=contact.data),
        has_stamp=False,
    ),
    Source(
        "/rover/truth/traversal",
        "std_msgs/msg/Float64MultiArray",
        _traversal,
        has_stamp=False,
    ),
)
ENERGY = (
    Source(
        "/battery/battery_state",
        "sensor_msgs/msg/BatteryState",
        lambda session, battery, stamp_ns: session.take_battery(
            stamp_ns, battery.voltage, battery.current
        ),
    ),
)
CLOCK = Source(
    "/clock",
    "rosgraph_msgs/msg/Clock",
    lambda _, message, __: None if is_time(message.clock) else Remark(NO_TIME),
    has_stamp=False,
)
