"""Sends commands to a rover, as a node of its own."""

from collections.abc import Iterator
from contextlib import contextmanager

from geometry_msgs.msg import TwistStamped
from rclpy.duration import Duration
from rclpy.publisher import Publisher

from harness.ros.commands import KINDS
from harness.ros.context import command_node
from rover_metrics.ros.subscriptions import keep_last

FRAME = "base_link"
PATIENCE = 1.0  # [s] for the last command to arrive


class Commander:
    """Sends to one topic.

    Args:
        publisher: Of Twist, or of TwistStamped without a stamp.
    """

    def __init__(self, publisher: Publisher) -> None:
        self._publisher = publisher
        self.topic: str = publisher.topic_name

    def send(self, linear: float, angular: float) -> None:
        """Sends a command: forwards [m/s], to the left [rad/s]."""
        message = self._publisher.msg_type()
        twist = message
        if isinstance(message, TwistStamped):
            message.header.frame_id, twist = FRAME, message.twist
        twist.linear.x, twist.angular.z = float(linear), float(angular)
        self._publisher.publish(message)

    def is_heard(self) -> bool:
        """Returns whether anybody listens."""
        return bool(self._publisher.get_subscription_count())

    def end(self) -> None:
        """Stops the rover."""
        self.send(0.0, 0.0)
        self._publisher.wait_for_all_acked(Duration(seconds=PATIENCE))


@contextmanager
def commander(namespace: str, kind: str) -> Iterator[Commander]:
    """Yields what commands the rover of a namespace, "" without one, by messages of one of KINDS.

    Raises:
        UsageError: ROS 2 refuses the environment.
    """
    name = f"/{namespace}/cmd_vel" if namespace else "/cmd_vel"
    with command_node("teleop") as (node, _):
        yield Commander(node.create_publisher(KINDS[kind], name, keep_last(10)))
