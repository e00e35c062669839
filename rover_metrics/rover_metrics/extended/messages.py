"""From messages to extended metrics; needs nothing of ROS but the shape of its messages."""

from collections.abc import Sequence
from typing import Any

from rover_metrics.extended.imu_columns import Quaternion
from rover_metrics.extended.metrics import NANOSECONDS, ExtendedMetrics
from rover_metrics.extended.truth_columns import TRAVERSAL

UNKNOWN = -1.0  # first covariance of what a sensor does not give (sensor_msgs/Imu)

Message = Any  # neither rclpy's nor rosbags' classes have types


def stamp_ns(message: Message) -> int:
    """Give the stamp of a message's header [ns]."""
    stamp = message.header.stamp
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


class MessageIntake:
    """Hands messages to ExtendedMetrics; `used` is whether the twelve columns have used them."""

    def __init__(self, metrics: ExtendedMetrics) -> None:
        self._metrics = metrics

    def scan(self, scan: Message, *, used: bool) -> None:
        """Take a sensor_msgs/LaserScan."""
        self._metrics.add_scan(
            stamp_ns(scan),
            scan.ranges,
            angle_min=scan.angle_min,
            angle_increment=scan.angle_increment,
            used=used,
        )

    def imu(self, imu: Message, *, used: bool) -> None:
        """Take a sensor_msgs/Imu."""
        a = imu.linear_acceleration
        self._metrics.add_imu(stamp_ns(imu), (a.x, a.y, a.z), _orientation(imu), used=used)

    def pose(self, poses: Message, *, used: bool) -> None:
        """Take a geometry_msgs/PoseArray."""
        p = poses.poses[0].position if poses.poses else None
        position = None if p is None else (p.x, p.y, p.z)
        self._metrics.add_pose(stamp_ns(poses), position, used=used)

    def odometry(self, odometry: Message, *, used: bool) -> None:
        """Take a nav_msgs/Odometry of the wheels."""
        v = odometry.twist.twist.linear
        self._metrics.add_odometry(stamp_ns(odometry), (v.x, v.y, v.z), used=used)

    def contact(self, contact: Message) -> bool:
        """Take a std_msgs/Bool of the truth; tells whether it was usable."""
        self._metrics.add_contact(touches=contact.data)
        return True

    def ground_truth(self, odometry: Message) -> bool:
        """Take a nav_msgs/Odometry of the truth; tells whether it was usable."""
        v = odometry.twist.twist.linear
        return self._metrics.add_true_velocity((v.x, v.y, v.z))

    def traversal(self, values: Message) -> bool:
        """Take a std_msgs/Float64MultiArray of the truth; tells whether it was usable."""
        return self._metrics.add_traversal(list(values.data), _names(values))


def _orientation(imu: Message) -> Quaternion | None:
    if imu.orientation_covariance[0] == UNKNOWN:
        return None
    q = imu.orientation
    return q.x, q.y, q.z, q.w


def _names(values: Message) -> Sequence[str]:
    label = values.layout.dim[0].label if values.layout.dim else ""
    return label.split(",") if label else TRAVERSAL
