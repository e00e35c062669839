"""A MetricsNode over real DDS in this process, for every test that wants one."""

import array
import resource
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from tests.support.waiting import PATIENCE

if TYPE_CHECKING:
    from rover_metrics.extended.settings import Settings
    from rover_metrics.metrics_node import MetricsNode

STARTED = datetime(2025, 1, 16, 12, 4, 57)

TRIANGLE = [0.0, 0.0, 1.0, 0.0, 0.0, 1.0]
VALUES: dict[str, Any] = {  # none of them the default
    "debug_mode": True,
    "debug_interval": 7,
    "fsync": True,
    "stale_after": 1.5,
    "publish_metrics": False,
    "collision_threshold": 0.75,
    "smoothness_threshold": 7.5,
    "min_safe_clearance": 0.25,
    "distance_threshold": 1.25,
    "rough_terrain_threshold": 11.0,
    "footprint": TRIANGLE,
    "lidar_pose": [0.1, 0.2, 0.3],
    "near_returns_as_contact": True,
    "footprint_threshold": 0.25,
    "gravity": 9.8,
    "wheels": "left,right",
    "extended_columns": True,
}

Message = Any  # neither messages nor publishers of rclpy have types
FullDisk = Callable[[int], AbstractContextManager[None]]
Vector3 = tuple[float, float, float]


class Rig:
    """A MetricsNode and a node that plays the simulator, in a ROS domain of their own."""

    def __init__(self, folder: Path, domain: int) -> None:
        import rclpy  # noqa: PLC0415 - the tests that need no ROS share this file

        self.folder, self.domain = folder, domain
        self.context = rclpy.Context()
        self.executor: Any = None
        self.nodes: list[Any] = []

    def start(
        self, *ros_args: str, settings: "Settings | None" = None, **parameters: object
    ) -> "MetricsNode":
        import rclpy  # noqa: PLC0415
        from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415
        from rclpy.parameter import Parameter  # noqa: PLC0415

        from rover_metrics.metrics_node import MetricsNode  # noqa: PLC0415

        # The level is the process's: whoever ran before may have changed it.
        args = ["--ros-args", "--log-level", "info", *ros_args]
        if not self.context.ok():  # where a node was refused it is up already
            rclpy.init(args=args, context=self.context, domain_id=self.domain)
        values = {"log_dir": str(self.folder), **parameters}
        given = [Parameter(name, value=value) for name, value in values.items()]
        node = MetricsNode(
            settings, context=self.context, parameter_overrides=given, now=lambda: STARTED
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        space = node.get_namespace()
        self.simulator = rclpy.create_node("simulator", context=self.context, namespace=space)
        self.nodes += [node, self.simulator]
        for each in self.nodes:
            self.executor.add_node(each)
        return node

    def publisher(self, message_type: type, topic: str, qos: object = 10) -> Message:
        """Create a publisher and wait until the node listens to it."""
        publisher = self.simulator.create_publisher(message_type, topic, qos)
        self.spin_until(lambda: publisher.get_subscription_count() == 1)
        return publisher

    def spin_until(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, "timed out"
            self.executor.spin_once(timeout_sec=0.02)

    def end(self, node: "MetricsNode") -> None:
        """Destroy a node as its program does at the end."""
        self.nodes.remove(node)
        node.destroy_node()

    def stop(self) -> None:
        for node in self.nodes:
            node.destroy_node()
        if self.executor is not None:
            self.executor.shutdown()
        self.context.try_shutdown()

    @staticmethod
    def scan(*ranges: float, stamp: float = 0.0, limits: tuple[float, float] = (0.0, 0.0)) -> Message:
        from sensor_msgs.msg import LaserScan  # noqa: PLC0415

        message = LaserScan(ranges=array.array("f", ranges), range_min=limits[0], range_max=limits[1])
        return _stamped(message, stamp)

    @staticmethod
    def imu(acceleration: Vector3, rate: Vector3 = (0.0, 0.0, 0.0), stamp: float = 0.0) -> Message:
        from sensor_msgs.msg import Imu  # noqa: PLC0415

        message = Imu()
        a, w = message.linear_acceleration, message.angular_velocity
        a.x, a.y, a.z = acceleration
        w.x, w.y, w.z = rate
        return _stamped(message, stamp)

    @staticmethod
    def pose(x: float, y: float, z: float, stamp: float = 0.0) -> Message:
        from geometry_msgs.msg import Point, Pose, PoseArray  # noqa: PLC0415

        return _stamped(PoseArray(poses=[Pose(position=Point(x=x, y=y, z=z))]), stamp)

    @staticmethod
    def odometry(x: float, y: float, z: float, stamp: float = 0.0) -> Message:
        from nav_msgs.msg import Odometry  # noqa: PLC0415

        message = Odometry()
        v = message.twist.twist.linear
        v.x, v.y, v.z = x, y, z
        return _stamped(message, stamp)


def _stamped(message: Message, stamp: float) -> Message:
    seconds = int(stamp)
    message.header.stamp.sec = seconds
    message.header.stamp.nanosec = round((stamp - seconds) * 1e9)
    return message


@pytest.fixture
def rig(tmp_path: Path, ros_domain: int) -> Iterator[Rig]:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")
    rig = Rig(tmp_path, ros_domain)
    yield rig
    rig.stop()


@contextmanager
def _files_no_longer_than(size: int) -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.fixture
def full_disk() -> FullDisk:
    """A file system that is nearly full: writes beyond a size are cut short, then fail."""
    return _files_no_longer_than
