import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseArray, PoseStamped
from nav_msgs.msg import Odometry
from rclpy.executors import ExternalShutdownException
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, LaserScan

from harness import samples
from harness.drivers.policy import Policy, write_policy
from harness.gym.policy_node import PolicyNode, main
from harness.robots import find_rover
from harness.testing import Trial
from tests.harness.gym.conftest import Make, MakeConfig

GOAL, PERIODS = (2.0, 1.0), 16
STAMP_NS, PERIOD_NS = 3_250_000_000, 50_000_000
KINDS = {"scan": LaserScan, "imu/data": Imu, "rover/pose_array": PoseArray, "odometry/wheels": Odometry}


class Asked:
    """A node without a goal, whose policy for four beams notes what it is asked."""

    def __init__(self) -> None:
        self.policy = Mock(beams=4)
        self.policy.command.return_value = samples.Twist(0.5, -0.25)
        self.node = PolicyNode(self.policy, find_rover("leo"))
        self._take = {one.topic_name: one.callback for one in self.node.subscriptions}

    def hear(self, *wrong: str, ns: int = STAMP_NS, beams: int = 4) -> list[tuple[float, float]]:
        """A tick: one message a topic but for some, then the clock; the goals it was asked for."""
        for topic, kind in KINDS.items():
            message: Any = kind()
            message.header.stamp.sec, message.header.stamp.nanosec = divmod(ns, 10**9)
            if topic == "scan":
                message.ranges = [1.5] * beams
            if topic == "rover/pose_array":
                message.poses = [PoseStamped().pose]
            if topic not in wrong:
                self._take[f"/{topic}"](serialize_message(message))
        self._take["/clock"](serialize_message(Clock()))
        goals = [call.args[1] for call in self.policy.command.call_args_list]
        self.policy.command.reset_mock()
        return goals

    def goal(self, x: float, y: float) -> None:
        message = PoseStamped()
        message.pose.position.x, message.pose.position.y = x, y
        self._take["/goal_pose"](serialize_message(message))


@pytest.fixture
def asked(ros_domain: int) -> Iterator[Asked]:
    with rclpy.init(domain_id=ros_domain):
        one = Asked()
        yield one
        one.node.destroy_node()


def test_each_scan_is_answered_once_and_none_without_a_goal_or_a_reading(asked: Asked) -> None:
    assert asked.hear() == []
    for x, y in ((math.nan, 1.0), (1.0, math.inf), (-math.inf, math.nan)):
        asked.goal(x, y)
        assert asked.hear() == []
    asked.goal(3.0, -4.0)
    asked.goal(math.nan, 1.0)
    assert asked.hear() == [(3.0, -4.0)]
    assert asked.hear() == []
    assert asked.hear(ns=STAMP_NS + PERIOD_NS) == [(3.0, -4.0)]
    assert asked.hear(ns=PERIOD_NS) == [(3.0, -4.0)], "another run, which begins anew"
    for beams in (3, 5):
        assert asked.hear(ns=STAMP_NS, beams=beams) == []


@pytest.mark.parametrize("missing", KINDS)
def test_before_every_topic_was_heard_nothing_is_answered(asked: Asked, missing: str) -> None:
    asked.goal(*GOAL)
    assert asked.hear(missing) == []
    assert asked.hear() == [GOAL]


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
        (["--ros-args", "-p", "a:=1", "--", "nowhere.npz"], "policy nowhere.npz cannot be read"),
        (["small.npz", "--ros-args", "--goal", "3,1"], "--goal stands behind --ros-args"),
        (["small.npz", "--ros-args", "-r", "no rule"], "give FROM:=TO"),
        (["small.npz", "--ros-args", "--log-level", "no level"], "ROS 2 refuses to start: "),
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


def pull_context(_: object) -> None:
    """What a signal does between two calls of rclpy."""
    rclpy.shutdown()
    raise RuntimeError("the given context is not valid")


@pytest.mark.parametrize("end", [KeyboardInterrupt, ExternalShutdownException, pull_context])
def test_a_node_that_is_stopped_ends_well(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    policy: Policy,
    ros_domain: int,
    end: Any,  # noqa: ANN401 - an exception, or what raises one
) -> None:
    made = Mock(wraps=PolicyNode)
    monkeypatch.setattr("harness.gym.policy_node.spin", Mock(side_effect=end))
    monkeypatch.setattr("harness.gym.policy_node.PolicyNode", made)
    write_policy(tmp_path / "small.npz", policy)
    words = [str(tmp_path / "small.npz"), "--goal", "3,-1", "--robot", "rover_zero4wd"]
    assert ros_domain >= 0
    assert main([*words, "--ros-args", "-p", "use_sim_time:=true"]) == 0
    read, *others = made.call_args.args
    assert (read.beams, *others) == (policy.beams, find_rover("rover_zero4wd"), (3.0, -1.0))
