"""What others ask of a run while it drives, over real DDS: to be put elsewhere, a goal, a pause."""

import math
import signal
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from tests.support.ros import Ros
from tests.support.waiting import PATIENCE, wait_until

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from rcl_interfaces.srv import GetParameters
from rclpy.executors import Executor
from sensor_msgs.msg import LaserScan
from std_srvs.srv import SetBool

from harness.base.interrupt import StopRequest
from harness.episode.batch import Batch
from harness.episode.loop import Observer
from harness.episode.result import Outputs, RunResult
from harness.episode.stream import RoverOrders
from harness.ros import session
from harness.ros.context import make_executor, spin_until
from harness.ros.hosted import HostedMetrics
from harness.ros.session import run_through_ros
from harness.samples import Place, Pose
from harness.spec.ros import RosOptions
from harness.spec.run import Run


class Stack:
    """Somebody in another participant, who asks between two batches and so at known times."""

    def __init__(self, ros: Ros) -> None:
        self.node = ros.node("stack")
        self.start = self.node.create_publisher(PoseWithCovarianceStamped, "/initialpose", 1)
        self.goal = self.node.create_publisher(PoseStamped, "/goal_pose", 1)
        self.ordered: list[int | None] = []
        self.poses: dict[int, Pose] = {}
        self.batches = 0

    def take(self, batch: Batch) -> None:
        """Puts the rover after 0.2 s, and sends it to a goal after 1 s."""
        samples = (sample for tick in batch.ticks for sample in tick.samples)
        self.poses |= {sample.stamp_ns: sample for sample in samples if isinstance(sample, Pose)}
        self.batches += 1
        if self.batches == 4:
            start = PoseWithCovarianceStamped()
            start.header.frame_id = "map"
            start.pose.pose.position.x, start.pose.pose.position.y = 3.0, 1.0
            start.pose.pose.orientation.z, start.pose.pose.orientation.w = 1.0, 0.0
            self._send(self.start, start)
        if self.batches == 20:
            goal = PoseStamped()
            goal.pose.position.x, goal.pose.position.y = 2.0, 1.0
            self._send(self.goal, goal)

    def _send(self, publisher: Any, message: object) -> None:  # noqa: ANN401 - rclpy has no types
        before = len(self.ordered)
        assert spin_until(self.run, publisher.get_subscription_count, PATIENCE)
        publisher.publish(message)
        assert spin_until(self.run, lambda: len(self.ordered) > before, PATIENCE)

    def watch(self, patch: pytest.MonkeyPatch) -> None:
        """Sees the executor of the run to come, and when what is ordered will be done."""

        def made(*args: Any, **options: Any) -> Executor:  # noqa: ANN401 - as make_executor
            self.run = make_executor(*args, **options)
            return self.run

        def noted(order: Any) -> Any:  # noqa: ANN401 - methods
            def note(orders: RoverOrders, place: Place) -> int | None:
                self.ordered.append(order(orders, place))
                return self.ordered[-1]

            return note

        patch.setattr(session, "make_executor", made)
        for name in ("put", "head_for"):
            patch.setattr(RoverOrders, name, noted(getattr(RoverOrders, name)))


def drive(folder: Path, run: Run, stop: StopRequest, *observers: Observer) -> RunResult:
    outputs = [Outputs(log_dir=folder, observers=observers)]
    (result,) = run_through_ros(run, outputs, RosOptions(log_dir=folder), stop)
    return result


def test_a_navigation_stack_puts_the_rover_elsewhere_and_sends_it_to_a_goal(
    ros: Ros, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stack = Stack(ros)
    stack.watch(monkeypatch)
    run = Run.of(terrain="posts", driver="goal", duration=5.5, lidar_beams=45)
    result = drive(tmp_path, run, StopRequest(), stack)
    assert (result.failure, result.lost, result.truth.resets) == (None, 0, 1)
    put_ns, _ = stack.ordered
    assert put_ns is not None
    before = stack.poses[max(at for at in stack.poses if at <= put_ns)]
    after = stack.poses[min(at for at in stack.poses if at > put_ns)]
    last = stack.poses[max(stack.poses)]
    assert before.position[:2] == pytest.approx((0.0, 0.0), abs=0.05)
    assert after.position[:2] == pytest.approx((3.0, 1.0), abs=0.05)
    assert abs(after.orientation[2]) == pytest.approx(1.0, abs=0.05)
    assert math.dist(last.position[:2], (2.0, 1.0)) < 0.4


@pytest.mark.usefixtures("ros_domain")
def test_a_strangers_message_in_the_log_at_the_end_of_a_run_fails_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    take_all = HostedMetrics.take_all

    def take_a_strangers(host: HostedMetrics) -> None:
        before, intruder = host.received()["/scan"], host.node.create_publisher(LaserScan, "scan", 10)
        wait_until(intruder.get_subscription_count)
        intruder.publish(LaserScan())
        wait_until(lambda: take_all(host) or host.received()["/scan"] > before)

    monkeypatch.setattr(HostedMetrics, "take_all", take_a_strangers)
    result = drive(tmp_path, Run.of(terrain="flat", driver="spin", duration=0.5), StopRequest())
    assert result.failure is not None
    assert result.failure.startswith("/scan has a second publisher")


def test_a_paused_run_stands_still_answers_goes_on_and_can_be_stopped(ros: Ros, tmp_path: Path) -> None:
    node, stop = ros.node("stack"), StopRequest()

    def pause(state: bool) -> str:
        response = ros.ask(node, SetBool, "harness/pause", data=state)
        assert response.success
        return str(response.message)

    def meddle() -> list[str]:
        pause(False)  # may be asked twice, until its answer finds who asked
        said = [pause(True), pause(True)]
        names = ["collision_threshold"]
        told = ros.ask(node, GetParameters, "metrics_node/get_parameters", names=names)
        assert told.values[0].double_value == 0.2
        said += [pause(False), pause(True)]
        stop.signal = signal.SIGINT  # as Ctrl-C leaves it
        return said

    with ThreadPoolExecutor() as threads:
        meddling = threads.submit(meddle)
        began = time.monotonic()
        result = drive(tmp_path, Run.of(terrain="flat", driver="spin", duration=3600.0), stop)
        took = time.monotonic() - began
        first, again, on, _ = meddling.result()
    paused_at = first.removeprefix("paused at ")
    assert again == f"paused already at {paused_at}"
    assert on == f"goes on at {paused_at}"
    assert (result.failure, result.interrupted) == (None, "SIGINT")
    assert 0.0 < result.paused_s < took - result.wall_s
    assert result.rows == int(result.simulated_s)
