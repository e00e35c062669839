"""A node of rclpy that turns away from what its lidar sees ahead: one command for each scan.

    python reflex.py --ros-args -p use_sim_time:=true
    python -m harness.run --driver cmd_vel --wait-for /reflex

reflex.mjs and reflex.c do the same: a drive with either gives the same bytes.
"""

import contextlib

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from sensor_msgs.msg import LaserScan

AHEAD = 0.5  # [rad] to either side
NEAR = 1.5  # [m]


class Reflex(Node):
    """Drives straight on while nothing is near ahead, and turns to the left otherwise."""

    def __init__(self) -> None:
        super().__init__("reflex")
        self._commands = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self.create_subscription(LaserScan, "scan", self.answer, 10)

    def answer(self, scan: LaserScan) -> None:
        """Publishes the command for a scan, with its stamp."""
        start, step = scan.angle_min, scan.angle_increment
        nearest = min(r for i, r in enumerate(scan.ranges) if abs(start + i * step) < AHEAD)
        is_free = nearest > NEAR
        command = TwistStamped()
        command.header.stamp = scan.header.stamp  # says which scan it answers
        command.twist.linear.x = 0.3 if is_free else 0.1
        command.twist.angular.z = 0.0 if is_free else 0.6
        self._commands.publish(command)


def main() -> None:
    """Runs the node until it is interrupted."""
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(Reflex())


if __name__ == "__main__":
    main()
