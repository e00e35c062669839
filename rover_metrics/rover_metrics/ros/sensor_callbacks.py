"""From messages to samples: what each subscription takes, leaves out and remarks upon.

Needs nothing of ROS but the shape of its messages.
"""

from collections.abc import Callable
from typing import Any

from rover_metrics.core.metrics import TraversalMetrics
from rover_metrics.extended.messages import MessageIntake, stamp_ns
from rover_metrics.health.reception import Reception
from rover_metrics.health.rejections import (
    JUMPED,
    NO_POSE,
    NOT_FINITE,
    NOT_FINITE_OR_OTHER,
    imu_fault,
    odometry_fault,
    scan_oddity,
    unusable_scan,
)

Message = Any  # rclpy's message classes have no types


class SensorCallbacks:
    """The callbacks of the four sensor topics, and of the truth for extended columns.

    Args:
        metrics: Takes the samples.
        reception: Counts the messages.
        debug: Is called with a topic and a text that is made only when it is wanted.
        extended: Takes every message after the metrics; None without extended columns.

    Attributes:
        scan, imu, pose, odometry: The topics, once they are resolved.
        ground_truth, contact, traversal: Likewise, of the truth.
    """

    def __init__(
        self,
        metrics: TraversalMetrics,
        reception: Reception,
        debug: Callable[[str, Callable[[], str]], None],
        extended: MessageIntake | None = None,
    ) -> None:
        self._metrics, self._reception, self._debug = metrics, reception, debug
        self._extended = extended
        self.scan = self.imu = self.pose = self.odometry = ""
        self.ground_truth = self.contact = self.traversal = ""

    def lidar_callback(self, scan: Message) -> None:
        """Take a scan; one without a finite range is open space, not a fault."""
        self._arrived(self.scan, scan)
        metrics = self._metrics
        used = metrics.add_scan(scan.ranges)
        if self._extended is not None:
            self._extended.scan(scan, used=used)
        if used:
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
        used = self._metrics.add_imu(acceleration, angular_velocity)
        if self._extended is not None:
            self._extended.imu(imu, used=used)
        if not used:
            self._reception.reject(self.imu, imu_fault(acceleration, angular_velocity))

    def pose_array_callback(self, poses: Message) -> None:
        """Take the first pose, which is the rover's."""
        self._arrived(self.pose, poses)
        metrics = self._metrics
        p = poses.poses[0].position if poses.poses else None
        used = p is not None and metrics.add_pose((p.x, p.y, p.z))
        if self._extended is not None:
            self._extended.pose(poses, used=used)
        if p is None:
            self._reception.reject(self.pose, NO_POSE)
            return
        if not used:
            self._reception.reject(self.pose, NOT_FINITE)
        elif metrics.last_step >= metrics.thresholds.distance_threshold:
            self._reception.remark(self.pose, JUMPED)
        self._debug(self.pose, self._pose_report)

    def odometry_callback(self, odometry: Message) -> None:
        """Take a wheel odometry sample."""
        self._arrived(self.odometry, odometry)
        v = odometry.twist.twist.linear
        velocity = (v.x, v.y, v.z)
        used = self._metrics.add_odometry(velocity)
        if self._extended is not None:
            self._extended.odometry(odometry, used=used)
        if not used:
            self._reception.reject(self.odometry, odometry_fault(velocity))

    def ground_truth_callback(self, odometry: Message) -> None:
        """Take the true velocity."""
        self._arrived(self.ground_truth, odometry)
        self._take_truth(self.ground_truth, MessageIntake.ground_truth, odometry)

    def contact_callback(self, contact: Message) -> None:
        """Take whether the rover touches a hazard."""
        self._reception.arrived(self.contact, None)
        self._take_truth(self.contact, MessageIntake.contact, contact)

    def traversal_callback(self, values: Message) -> None:
        """Take slip and roughness."""
        self._reception.arrived(self.traversal, None)
        self._take_truth(self.traversal, MessageIntake.traversal, values)

    def _take_truth(
        self, topic: str, take: Callable[[MessageIntake, Message], bool], message: Message
    ) -> None:
        if self._extended is not None and not take(self._extended, message):
            self._reception.reject(topic, NOT_FINITE_OR_OTHER)

    def _arrived(self, topic: str, message: Message) -> None:
        self._reception.arrived(topic, stamp_ns(message))

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
