"""Command: a ROS 2 node that drives as a policy does that was trained on RoverHarness/PointNav.

    python -m harness.gym.policy_node FILE.npz --goal 3,1 --ros-args -p use_sim_time:=true
    python -m harness.run --driver cmd_vel --wait-for /policy

It subscribes to /scan, /imu/data, /rover/pose_array, /odometry/wheels and /goal_pose, and answers with
/cmd_vel when /clock says that all of a scan's tick has been sent. In lock-step it drives the path that
the policy drives in its environment.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from rover_metrics.errors import begin_program, run_program
from rover_metrics.parser import OneLineParser

if __name__ == "__main__":
    begin_program("harness.gym.policy_node")

from harness.base.errors import needing_ros

with needing_ros():
    from geometry_msgs.msg import PoseArray, PoseStamped, Twist
    from nav_msgs.msg import Odometry as OdometryMessage
    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from rosgraph_msgs.msg import Clock
    from sensor_msgs.msg import Imu as ImuMessage
    from sensor_msgs.msg import LaserScan as ScanMessage

import numpy as np

from harness import samples
from harness.drivers import point_nav
from harness.drivers.policy import Policy, read_policy
from harness.robots import RoverSpec, find_rover
from rover_metrics.ros.arguments import parsed_beside_ros
from rover_metrics.ros.guarded_node import GuardedNode
from rover_metrics.ros.program import spin, started
from rover_metrics.topics import quaternion, stamp_ns, vector

BEST_EFFORT = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)


class PolicyNode(GuardedNode):
    """Answers each scan with the policy's command; silent without a goal.

    Args:
        policy: What drives.
        rover: Whose largest speeds an action is a share of.
        goal: Where to in the world [m], until /goal_pose says otherwise; None for nowhere yet.
    """

    def __init__(
        self, policy: Policy, rover: RoverSpec, goal: tuple[float, float] | None = None
    ) -> None:
        super().__init__("policy")
        self._policy, self._rover, self._goal = policy, rover, goal
        self._readings: dict[type[samples.Sample], samples.Sample] = {}
        self._answered_ns = 0  # the stamp of the last scan that was answered
        self._command = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(ScanMessage, "scan", self._on_scan, 10)
        self.create_subscription(ImuMessage, "imu/data", self._on_imu, 10)
        self.create_subscription(PoseArray, "rover/pose_array", self._on_pose, BEST_EFFORT)
        self.create_subscription(OdometryMessage, "odometry/wheels", self._on_odometry, 10)
        self.create_subscription(PoseStamped, "goal_pose", self._on_goal, 10)
        self.create_subscription(Clock, "/clock", self._on_clock, 10)

    def _on_scan(self, message: ScanMessage) -> None:
        if len(message.ranges) == self._policy.beams:
            ranges = np.array(message.ranges, np.float32)
            self._readings[samples.LaserScan] = samples.LaserScan(stamp_ns(message), ranges)
            return
        self.get_logger().error(
            f"the policy is for {self._policy.beams} beams, /scan has {len(message.ranges)}: no answer",
            throttle_duration_sec=5.0,
        )

    def _on_imu(self, message: ImuMessage) -> None:
        self._readings[samples.Imu] = samples.Imu(
            stamp_ns(message),
            quaternion(message.orientation),
            vector(message.angular_velocity),
            vector(message.linear_acceleration),
        )

    def _on_pose(self, message: PoseArray) -> None:
        for pose in message.poses[:1]:
            place, attitude = vector(pose.position), quaternion(pose.orientation)
            self._readings[samples.Pose] = samples.Pose(stamp_ns(message), place, attitude)

    def _on_odometry(self, message: OdometryMessage) -> None:
        twist = message.twist.twist
        moved = samples.Twist(twist.linear.x, twist.angular.z)
        self._readings[samples.Odometry] = samples.Odometry(stamp_ns(message), 0.0, 0.0, 0.0, moved)

    def _on_goal(self, message: PoseStamped) -> None:
        place = message.pose.position
        if math.isfinite(place.x) and math.isfinite(place.y):
            self._goal = place.x, place.y

    def _on_clock(self, _: Clock) -> None:
        if self._goal is None or not self._readings.keys() >= point_nav.SENSED:
            return
        stamp_ns = point_nav.latest(self._readings, samples.LaserScan).stamp_ns
        if stamp_ns != self._answered_ns:
            self._answered_ns = stamp_ns
            command = self._policy.command(self._readings, self._goal, self._rover)
            twist = Twist()
            twist.linear.x, twist.angular.z = command.linear, command.angular
            self._command.publish(twist)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the node until it is stopped; returns its exit code."""
    words = sys.argv[1:] if arguments is None else arguments
    options, ros_args = parsed_beside_ros(_parser(), words)
    return run_program("harness.gym.policy_node", lambda: _run(options, ros_args))


def _run(options: argparse.Namespace, ros_args: list[str]) -> int:
    policy, rover = read_policy(options.file), find_rover(options.robot)
    with suppress(KeyboardInterrupt, ExternalShutdownException), started(ros_args):
        executor = SingleThreadedExecutor()
        executor.add_node(PolicyNode(policy, rover, options.goal))
        spin(executor)
    return 0


def _goal(text: str) -> tuple[float, float]:
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        x = y = math.nan
    if not (math.isfinite(x) and math.isfinite(y)):
        raise argparse.ArgumentTypeError(f"'{text}' is not valid; give X,Y in metres")
    return x, y


def _parser() -> OneLineParser:
    parser = OneLineParser(
        prog="python -m harness.gym.policy_node",
        description="Drives as a policy does, over ROS 2.",
        epilog="Arguments after --ros-args go to ROS; -p use_sim_time:=true is needed for lock-step.",
    )
    parser.add_argument("file", type=Path, metavar="FILE.npz", help="the policy (docs/gym.md)")
    parser.add_argument("--robot", default="leo", metavar="NAME|FOLDER", help="whose speeds it commands")
    about = "where to drive, in metres; later ones come by /goal_pose"
    parser.add_argument("--goal", type=_goal, metavar="X,Y", help=about)
    return parser


if __name__ == "__main__":
    sys.exit(main())
