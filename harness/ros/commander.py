"""Sends commands to a rover, as a node of its own."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from geometry_msgs.msg import TwistStamped
from rclpy.duration import Duration
from rclpy.publisher import Publisher

from harness.ros.commands import KINDS
from harness.ros.context import command_node
from rover_metrics.ros.subscriptions import keep_last

FRAME = "base_link"
PATIENCE = 1.0  # [s] for the last command to arrive


@contextmanager
def commander(namespace: str, kind: str) -> Iterator[tuple[Publisher, Callable[[float, float], None]]]:
    """Yields a publisher of commands, and what sends one: forwards [m/s], to the left [rad/s].

    At the end the rover is told to stand.

    Args:
        namespace: Of the rover; "" without one.
        kind: Of the messages, one of KINDS.

    Raises:
        UsageError: ROS 2 refuses the environment.
    """
    name = f"/{namespace}/cmd_vel" if namespace else "/cmd_vel"
    with command_node("teleop") as (node, _):
        publisher = node.create_publisher(KINDS[kind], name, keep_last(10))

        def send(linear: float, angular: float) -> None:
            message = twist = publisher.msg_type()
            if isinstance(message, TwistStamped):
                message.header.frame_id, twist = FRAME, message.twist
            twist.linear.x, twist.angular.z = float(linear), float(angular)
            publisher.publish(message)

        yield publisher, send
        send(0.0, 0.0)
        publisher.wait_for_all_acked(Duration(seconds=PATIENCE))
