"""A navigation stack's client over real DDS: the map when joining late, a teleport, a goal."""

import math
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.support.waiting import PATIENCE

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from harness.base.interrupt import StopRequest
from harness.episode.assembly import world_of
from harness.episode.batch import Batch
from harness.episode.result import Outputs
from harness.robots import find_rover
from harness.ros import session
from harness.ros.context import make_executor, ros_context, spin_until
from harness.ros.session import run_through_ros
from harness.spec.ros import RosOptions
from harness.spec.run import Run
from harness.world.occupancy import occupancy

LATCHED = QoSProfile(
    depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


class Client:
    """Somebody in another participant, who acts between two batches and so at known times."""

    def __init__(self, at_end: ExitStack) -> None:
        context = at_end.enter_context(ros_context([]))
        self.executor = at_end.enter_context(make_executor(context))
        self.node = rclpy.create_node("client", context=context)
        self.executor.add_node(self.node)
        self.where: list[tuple[float, float, float]] = []
        self.maps: dict[str, Any] = {}
        self.node.create_subscription(Odometry, "/odom_ground_truth", self._note, 10)
        self.start = self.node.create_publisher(PoseWithCovarianceStamped, "/initialpose", 1)
        self.goal = self.node.create_publisher(PoseStamped, "/goal_pose", 1)
        self.batches = 0

    def is_heard_by(self, run: Any) -> None:  # noqa: ANN401 - of the session
        """Waits until the run's first message will reach the client."""
        (truth,) = (c for c in run.rovers[0].bridge.channels if c.topic == "/odom_ground_truth")
        self.until(lambda: truth.publisher.get_subscription_count() > 0)

    def take(self, _: Batch) -> None:
        self.batches += 1
        self.until(lambda: len(self.where) >= 2 * self.batches)
        if self.batches == 4:
            self.listen("early")
            start = PoseWithCovarianceStamped()
            start.header.frame_id = "map"
            start.pose.pose.position.x, start.pose.pose.position.y = 3.0, 1.0
            start.pose.pose.orientation.z = 1.0
            start.pose.pose.orientation.w = 0.0
            self.until(lambda: self.start.get_subscription_count() > 0)
            self.start.publish(start)
        if self.batches == 20:
            self.until(lambda: "early" in self.maps)
            self.listen("late")
            goal = PoseStamped()
            goal.pose.position.x, goal.pose.position.y = 2.0, 1.0
            self.goal.publish(goal)
        if self.batches == 30:
            self.until(lambda: "late" in self.maps)

    def listen(self, when: str) -> None:
        self.node.create_subscription(
            OccupancyGrid, "/map", lambda grid: self.maps.setdefault(when, grid), LATCHED
        )

    def until(self, condition: Any) -> None:  # noqa: ANN401 - a predicate
        assert spin_until(self.executor, condition, PATIENCE)

    def _note(self, message: Odometry) -> None:
        pose = message.pose.pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        self.where.append((pose.position.x, pose.position.y, math.remainder(yaw, math.tau)))


@pytest.mark.usefixtures("ros_domain")
def test_a_client_gets_the_map_puts_the_rover_and_sends_it_to_a_goal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    config = Run.of(terrain="posts", driver="goal", duration=5.5, lidar_beams=45)
    options = RosOptions(log_dir=tmp_path, host_metrics=False)
    drive = session._Session.drive
    with ExitStack() as at_end:
        client = Client(at_end)

        def drive_once_heard(run: Any, *words: Any) -> Any:  # noqa: ANN401 - of the session
            client.is_heard_by(run)
            return drive(run, *words)

        monkeypatch.setattr(session._Session, "drive", drive_once_heard)
        outputs = [Outputs(log_dir=options.log_dir, observers=[client])]
        (result,) = run_through_ros(config, outputs, options, StopRequest())
    assert result.failure is None
    assert (result.lost, result.truth.resets) == (0, 1)
    rover = find_rover("leo")
    cells = occupancy(world_of(config), rover.slope_limit, rover.step_limit).cells
    for grid in client.maps.values():
        assert (np.array(grid.data).reshape(grid.info.height, -1) == cells).all()
    assert sorted(client.maps) == ["early", "late"]
    put = next(i for i, (x, _, _) in enumerate(client.where) if x > 1.0)
    assert client.where[put - 1][:2] == pytest.approx((0.0, 0.0), abs=0.05)
    assert client.where[put][:2] == pytest.approx((3.0, 1.0), abs=0.05)
    assert abs(client.where[put][2]) == pytest.approx(math.pi, abs=0.05)
    assert client.where[-1][:2] == pytest.approx((2.0, 1.0), abs=0.4)
