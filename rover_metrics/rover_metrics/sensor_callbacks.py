"""From messages to samples: what each subscription takes, leaves out and remarks upon.

Needs nothing of ROS but the shape of its messages.
"""

from collections.abc import Callable
from typing import Any

from rover_metrics.faults import (
    JUMPED,
    NO_POSE,
    NOT_FINITE,
    imu_fault,
    odometry_fault,
    scan_oddity,
    unusable_scan,
)
from rover_metrics.metrics import TraversalMetrics
from rover_metrics.reception import Reception

NANOSECONDS = 1_000_000_000

Message = Any  # rclpy's message classes have no types


class SensorCallbacks:
    """The callbacks of the four sensor topics.

    Args:
        metrics: Takes the samples.
        reception: Counts the messages.
        debug: Is called with a topic and a text that is made only when it is wanted.

    Attributes:
        scan, imu, pose, odometry: The topics, once they are resolved.
    """

    def __init__(
        self,
        metrics: TraversalMetrics,
        reception: Reception,
        debug: Callable[[str, Callable[[], str]], None],
    ) -> None:
        self._metrics, self._reception, self._debug = metrics, reception, debug
        self.scan = self.imu = self.pose = self.odometry = ""

    def lidar_callback(self, scan: Message) -> None:
        """Take a scan; one without a finite range is open space, not a fault."""
        self._arrived(self.scan, scan)
        metrics = self._metrics
        if metrics.add_scan(scan.ranges):
            oddity = scan_oddity(metrics.clearance, metrics.farthest, scan.range_min, scan.range_max)
        else:
            oddity = unusable_scan(scan.ranges)
        if oddity is not None:
            self._reception.remark(self.scan, oddity)
        self._debug(self.scan, self._scan_report)

    def imu_callback(self, imu: Message) -> None:
        """Take an IMU sample."""
        self._arrived(self.imu, imu)
        a, w = imu.linear_acceleration, imu.angular_velocity
        acceleration, angular_velocity = (a.x, a.y, a.z), (w.x, w.y, w.z)
        if not self._metrics.add_imu(acceleration, angular_velocity):
            self._reception.reject(self.imu, imu_fault(acceleration, angular_velocity))

    def pose_array_callback(self, poses: Message) -> None:
        """Take the first pose, which is the rover's."""
        self._arrived(self.pose, poses)
        if not poses.poses:
            self._reception.reject(self.pose, NO_POSE)
            return
        p, metrics = poses.poses[0].position, self._metrics
        if not metrics.add_pose((p.x, p.y, p.z)):
            self._reception.reject(self.pose, NOT_FINITE)
        elif metrics.last_step >= metrics.thresholds.distance_threshold:
            self._reception.remark(self.pose, JUMPED)
        self._debug(self.pose, self._pose_report)

    def odometry_callback(self, odometry: Message) -> None:
        """Take a wheel odometry sample."""
        self._arrived(self.odometry, odometry)
        v = odometry.twist.twist.linear
        velocity = (v.x, v.y, v.z)
        if not self._metrics.add_odometry(velocity):
            self._reception.reject(self.odometry, odometry_fault(velocity))

    def _arrived(self, topic: str, message: Message) -> None:
        stamp = message.header.stamp
        self._reception.arrived(topic, stamp.sec * NANOSECONDS + stamp.nanosec)

    def _scan_report(self) -> str:
        return (
            f"LIDAR: clearance {self._metrics.clearance:.4f} m, "
            f"total collisions {self._metrics.total_collisions}"
        )

    def _pose_report(self) -> str:
        return (
            f"Position update: distance {self._metrics.last_step:.4f} m, "
            f"total {self._metrics.total_distance:.4f} m"
        )
