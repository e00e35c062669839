"""A node that answers scans from a thread of its own, when the simulation has gone on or will not."""

import queue
import sys
import threading

import rclpy
from geometry_msgs.msg import TwistStamped
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

LATE_NS = 100_000_000
STANDSTILL = 0.02  # [s] of wall time without /clock: somebody waits


class Threaded(Node):  # type: ignore[misc]  # rclpy has no types
    """Turns by the parity of scans, each answered as late as the simulation lets it."""

    def __init__(self) -> None:
        super().__init__("threaded")
        self._commands = self.create_publisher(TwistStamped, "cmd_vel", 10)
        self._scans: queue.Queue[LaserScan] = queue.Queue()
        self._ticked, self._now_ns, self._count = threading.Condition(), 0, 0
        self.create_subscription(LaserScan, "scan", self._scans.put, 10)
        self.create_subscription(Clock, "/clock", self._tick, 10)
        threading.Thread(target=self._work, daemon=True).start()

    def _tick(self, clock: Clock) -> None:
        with self._ticked:
            self._now_ns = clock.clock.sec * 10**9 + clock.clock.nanosec
            self._ticked.notify()

    def _work(self) -> None:
        while True:
            scan = self._scans.get()
            due = scan.header.stamp.sec * 10**9 + scan.header.stamp.nanosec + LATE_NS
            with self._ticked:
                while self._now_ns < due and self._ticked.wait(STANDSTILL):
                    pass
            self._count += 1
            command = TwistStamped()
            command.header.stamp = scan.header.stamp
            command.twist.linear.x, command.twist.angular.z = 0.3, 0.8 * (self._count % 40 < 20)
            if "silent" not in sys.argv:
                self._commands.publish(command)


if __name__ == "__main__":
    rclpy.init()
    rclpy.spin(Threaded())
