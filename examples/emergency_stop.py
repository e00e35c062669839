"""A node that is not part of the harness: it stops the rover before something, or when it is blind."""

import contextlib
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Bool

STOP_DISTANCE = 0.8  # [m]
SILENCE = 0.25  # [s] without a usable scan that counts as blind


class EmergencyStop(Node):
    """Publishes zero on cmd_vel and true on emergency_stop, and keeps to it."""

    def __init__(self) -> None:
        super().__init__("emergency_stop")
        self.stopped = False
        self._seen = self.get_clock().now()
        self._command = self.create_publisher(Twist, "cmd_vel", 10)
        self._alarm = self.create_publisher(Bool, "emergency_stop", 10)
        self.create_subscription(LaserScan, "scan", self._on_scan, 10)
        self.create_timer(0.05, self._watch)

    def _on_scan(self, scan: LaserScan) -> None:
        ranges = [r for r in scan.ranges if not math.isnan(r)]
        if ranges:
            self._seen = self.get_clock().now()
        if min(ranges, default=math.inf) < STOP_DISTANCE:  # -inf: nearer than the lidar can see
            self._stop()

    def _watch(self) -> None:
        if (self.get_clock().now() - self._seen).nanoseconds > SILENCE * 1e9:
            self._stop()

    def _stop(self) -> None:
        if not self.stopped:
            self.stopped = True
            self._command.publish(Twist())
            self._alarm.publish(Bool(data=True))


def main() -> None:
    """Runs the node until Ctrl-C."""
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(EmergencyStop())


if __name__ == "__main__":
    main()
