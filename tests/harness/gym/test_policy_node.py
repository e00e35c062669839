import math
from contextlib import nullcontext
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import Pose, PoseArray, PoseStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.qos import ReliabilityPolicy
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan

from harness import samples
from harness.drivers.policy import Policy, write_policy
from harness.gym import policy_node
from harness.gym.policy_node import PolicyNode, main
from harness.robots import find_rover
from harness.testing import Trial
from rover_metrics.ros.guarded_node import GuardedNode
from tests.harness.gym.conftest import Make, MakeConfig

GOAL, PERIODS = (2.0, 1.0), 16
STAMP_NS = 3_250_000_000


class Heard:
    """A node without ROS: its topics by name, the policy that it asks and what it answers."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, goal: tuple[float, float] | None) -> None:
        self.policy = Mock(beams=4)
        self.policy.command.return_value = samples.Twist(0.5, -0.25)
        self.topics: dict[str, Any] = {}
        self.sent, self.log = Mock(), Mock()

        self.subscribed: dict[str, tuple[type, Any]] = {}

        def subscribed(_: object, kind: type, topic: str, callback: Any, qos: object) -> None:  # noqa: ANN401
            self.topics[topic], self.subscribed[topic] = callback, (kind, qos)

        monkeypatch.setattr(GuardedNode, "__init__", lambda *_: None)
        monkeypatch.setattr(PolicyNode, "create_subscription", subscribed)
        publisher = {(Twist, "cmd_vel", 10): self.sent}  # of the node's namespace
        monkeypatch.setattr(PolicyNode, "create_publisher", lambda _, *told: publisher[told])
        monkeypatch.setattr(PolicyNode, "get_logger", lambda _: self.log)
        self.node = PolicyNode(self.policy, find_rover("leo"), goal)

    def hear(self, *wrong: str, ns: int = STAMP_NS, beams: int = 4) -> None:
        """A tick: one message a topic but for some, then the clock."""
        messages = {"scan": LaserScan(), "imu/data": Imu(), "rover/pose_array": PoseArray()}
        messages["odometry/wheels"] = Odometry()
        for message in messages.values():
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns, 10**9)
        messages["scan"].ranges = [1.5, math.inf, -math.inf, 2.5, 3.5][:beams]
        imu = messages["imu/data"]
        imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z = 0.1, 0.2, 0.3
        force = imu.linear_acceleration
        force.x, force.y, force.z = 1.0, 2.0, 9.5
        turn = imu.orientation
        turn.x, turn.y, turn.z, turn.w = 0.1, 0.3, 0.5, 0.7
        first, second = Pose(), Pose()
        first.position.x, first.position.y, first.position.z = 4.0, 5.0, 6.0
        turn = first.orientation
        turn.x, turn.y, turn.z, turn.w = 0.2, 0.4, 0.6, 0.8
        messages["rover/pose_array"].poses = [first, second]
        twist = messages["odometry/wheels"].twist.twist
        twist.linear.x, twist.angular.z = 0.75, -1.25
        for topic, message in messages.items():
            if topic not in wrong:
                self.topics[topic](message)
        self.topics["/clock"](Clock())

    def goal(self, x: float, y: float) -> None:
        message = PoseStamped()
        message.pose.position.x, message.pose.position.y = x, y
        self.topics["goal_pose"](message)


def test_the_policy_is_asked_with_what_was_heard_and_its_answer_is_sent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard = Heard(monkeypatch, GOAL)
    _, best_effort = heard.subscribed.pop("rover/pose_array")
    assert (best_effort.depth, best_effort.reliability) == (10, ReliabilityPolicy.BEST_EFFORT)
    assert heard.subscribed == {
        "scan": (LaserScan, 10),
        "imu/data": (Imu, 10),
        "odometry/wheels": (Odometry, 10),
        "goal_pose": (PoseStamped, 10),
        "/clock": (Clock, 10),
    }
    heard.hear()
    (readings, goal, rover), _ = heard.policy.command.call_args
    scan = readings.pop(samples.LaserScan)
    assert (scan.stamp_ns, scan.ranges.tolist()) == (STAMP_NS, [1.5, math.inf, -math.inf, 2.5])
    assert readings == {
        samples.Imu: samples.Imu(STAMP_NS, (0.1, 0.3, 0.5, 0.7), (0.1, 0.2, 0.3), (1.0, 2.0, 9.5)),
        samples.Pose: samples.Pose(STAMP_NS, (4.0, 5.0, 6.0), (0.2, 0.4, 0.6, 0.8)),
        samples.Odometry: samples.Odometry(STAMP_NS, 0.0, 0.0, 0.0, samples.Twist(0.75, -1.25)),
    }
    assert (goal, rover) == (GOAL, find_rover("leo"))
    (twist,) = heard.sent.publish.call_args.args
    assert (twist.linear.x, twist.angular.z, twist.linear.y, twist.angular.x) == (0.5, -0.25, 0.0, 0.0)


def test_each_scan_is_answered_once_and_none_without_a_goal_or_a_reading(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    heard, topics = Heard(monkeypatch, None), ("scan", "imu/data", "rover/pose_array", "odometry/wheels")
    asked = heard.policy.command
    heard.hear()
    for missing in topics:
        heard.node._readings.clear()
        heard.goal(*GOAL)
        heard.hear(missing)
        assert asked.call_count == 0, missing
    heard.node._goal = None
    heard.hear()
    for x, y in ((math.nan, 1.0), (1.0, math.inf), (-math.inf, math.nan)):
        heard.goal(x, y)
        heard.hear()
    assert asked.call_count == 0
    heard.goal(3.0, -4.0)
    heard.goal(math.nan, 1.0)
    scans = (STAMP_NS, 1), (STAMP_NS, 0), (STAMP_NS + 50_000_000, 1), (50_000_000, 1)  # a run, another
    for ns, answers in scans:
        asked.reset_mock()
        heard.hear(ns=ns)
        assert [call.args[1] for call in asked.call_args_list] == [(3.0, -4.0)] * answers
    assert heard.sent.publish.call_count == 3
    assert not heard.log.error.called
    for beams in (3, 5):
        heard.hear(ns=STAMP_NS + 10**8, beams=beams)
        assert asked.call_count == 1  # the last scan that it can read was answered
        told = f"the policy is for 4 beams, /scan has {beams}: no answer"
        heard.log.error.assert_called_with(told, throttle_duration_sec=5.0)


def test_through_dds_the_node_drives_the_path_of_the_environment(
    make: Make, config: MakeConfig, policy: Policy
) -> None:
    env = make(noise="hardware", random_start=False)
    seen, _ = env.reset(seed=4, options={"goal": GOAL})
    driven = []
    for _ in range(PERIODS):
        seen, *_ = env.step(policy.act(seen))
        driven.append(env.driven.simulation.position)
    run = config(seed=4, duration=2.0, driver="cmd_vel")
    with Trial(run) as trial:
        node = trial.host(lambda: PolicyNode(policy, find_rover(run.rover.robot), GOAL))
        assert node.get_fully_qualified_name() == "/policy"
        poses = trial.collect(PoseArray, "rover/pose_array")
        trial.step(0.05 * (1 + PERIODS))
    told = {
        round(100 * time): message.poses[0].position
        for time, message in zip(poses.times, poses.messages, strict=True)
    }
    # Poses come every 20 ms, so that every second period has one at its end.
    both = [(told[5 * n], driven[n - 2]) for n in range(2, 2 + PERIODS, 2)]
    assert [(pose.x, pose.y, pose.z) for pose, _ in both] == [place for _, place in both]
    assert math.dist(both[0][1], both[-1][1]) > 0.02  # it does not just stand


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["nowhere.npz"], "policy nowhere.npz cannot be read: No such file or directory"),
        (["small.npz", "--goal", "-3,1", "--robot", "spirit"], "robot 'spirit' does not exist"),
        (["small.npz", "--goal", "3"], "'3' is not valid; give X,Y in metres"),
        (["small.npz", "--goal", "3,nan"], "'3,nan' is not valid; give X,Y in metres"),
        (["small.npz", "--goal", "1,2,3"], "'1,2,3' is not valid; give X,Y in metres"),
        (["small.npz", "--goal", "inf,3"], "'inf,3' is not valid; give X,Y in metres"),
        (["--ros-args", "-p", "a:=1", "--", "nowhere.npz"], "policy nowhere.npz cannot be read"),
        (["small.npz", "--ros-args", "--goal", "3,1"], "--goal stands behind --ros-args"),
        (["small.npz", "--ros-args", "-r", "no rule"], "ROS 2 refuses to start: "),
        (["nowhere.npz", "--ros-args", "-p", "use_sim_time:=true"], "policy nowhere.npz cannot be read"),
    ],
)
def test_what_is_not_valid_is_told_in_a_line(
    words: list[str],
    told: str,
    policy: Policy,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    write_policy(Path("small.npz"), policy)
    try:
        code: object = main(words)
    except SystemExit as ended:  # argparse's way
        code = ended.code
    assert code == 2
    heard = capsys.readouterr().err
    assert told in heard
    assert heard.count("\n") == 1


@pytest.mark.parametrize("end", [None, KeyboardInterrupt, ExternalShutdownException])
def test_it_drives_the_rover_to_the_goal_that_it_is_told_until_it_is_stopped(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, policy: Policy, end: type[BaseException] | None
) -> None:
    node, spin, init = Mock(), Mock(side_effect=end), Mock(return_value=nullcontext())
    monkeypatch.setattr(policy_node, "PolicyNode", node)
    monkeypatch.setattr(policy_node, "rclpy", Mock(init=init, spin=spin))
    write_policy(tmp_path / "small.npz", policy)
    ros_args = ["--ros-args", "-p", "use_sim_time:=true"]
    words = [str(tmp_path / "small.npz"), "--goal", "3,-1", "--robot", "rover_zero4wd", *ros_args]
    assert main(words) == 0
    init.assert_called_once_with(args=ros_args)
    read, *told = node.call_args.args
    assert (read.beams, *told) == (policy.beams, find_rover("rover_zero4wd"), (3.0, -1.0))
    spin.assert_called_once_with(node.return_value)
    monkeypatch.setattr("sys.argv", ["policy_node", *words[:1]])
    assert main() == 0
    assert node.call_args.args[1:] == (find_rover("leo"), None)


def test_help_tells_how_it_is_run(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    told = capsys.readouterr().out
    assert told.startswith("usage: python -m harness.gym.policy_node ")
    assert "-p use_sim_time:=true" in told
