import math
from contextlib import nullcontext
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from geometry_msgs.msg import PoseArray

from harness.config import EpisodeConfig
from harness.drivers.policy import BESIDE_LIDAR, Policy, write_policy
from harness.gym import policy_node
from harness.gym.policy_node import PolicyNode, main
from harness.robots import find_rover
from harness.testing import Trial
from tests.harness.gym.conftest import Make

GOAL, PERIODS = (2.0, 1.0), 16


def test_through_dds_the_node_drives_the_path_of_the_environment(
    make: Make, small: dict[str, Any]
) -> None:
    rng, size = np.random.default_rng(1), BESIDE_LIDAR + small["lidar_beams"]
    layers = tuple(
        (rng.normal(0.0, 0.2, shape).astype("f4"), rng.normal(0.0, 0.3, shape[1]).astype("f4"))
        for shape in ((size, 6), (6, 2))
    )
    policy = Policy(layers)
    env = make(noise="hardware", random_start=False)
    seen, _ = env.reset(seed=4, options={"goal": GOAL})
    driven = []
    for _ in range(PERIODS):
        seen, *_ = env.step(policy.act(seen))
        driven.append(env._ride.simulation.position)
    config = EpisodeConfig(
        terrain=small["terrain"],
        terrain_size=(small["terrain_size"],) * 2,
        robot=small["robot"],
        seed=4,
        duration=2.0,
        noise="hardware",
        lidar_beams=small["lidar_beams"],
        driver="cmd_vel",
    )
    with Trial(config) as trial:
        node = trial.host(lambda: PolicyNode(policy, find_rover(small["robot"]), GOAL))
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
        (["small.npz", "--ros-args", "-r", "no rule"], "ROS 2 refuses to start: "),
        (["nowhere.npz", "--ros-args", "-p", "use_sim_time:=true"], "policy nowhere.npz cannot be read"),
    ],
)
def test_what_is_not_valid_is_told_in_a_line(
    words: list[str],
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    layer = np.zeros((BESIDE_LIDAR + 8, 2), np.float32), np.zeros(2, np.float32)
    write_policy(Path("small.npz"), Policy((layer,)))
    try:
        code: object = main(words)
    except SystemExit as ended:  # argparse's way
        code = ended.code
    assert code == 2
    heard = capsys.readouterr().err
    assert told in heard
    assert heard.count("\n") == 1


def test_it_drives_the_rover_to_the_goal_that_it_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    node, spin = Mock(), Mock()
    monkeypatch.setattr(policy_node, "PolicyNode", node)
    monkeypatch.setattr(policy_node, "rclpy", Mock(init=Mock(return_value=nullcontext()), spin=spin))
    layer = np.zeros((BESIDE_LIDAR + 8, 2), np.float32), np.zeros(2, np.float32)
    write_policy(tmp_path / "small.npz", Policy((layer,)))
    assert main([str(tmp_path / "small.npz"), "--goal", "3,-1", "--robot", "rover_zero4wd"]) == 0
    policy, rover, goal = node.call_args.args
    assert (policy.beams, rover, goal) == (8, find_rover("rover_zero4wd"), (3.0, -1.0))
    spin.assert_called_once_with(node.return_value)


def test_help_tells_how_it_is_run(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="0"):
        main(["--help"])
    told = capsys.readouterr().out
    assert told.startswith("usage: python -m harness.gym.policy_node ")
    assert "-p use_sim_time:=true" in told
