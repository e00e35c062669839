import math
import re
from typing import Any

import numpy as np
import pytest

from harness.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist
from tests.harness.gym.conftest import Make

STILL, AHEAD = np.zeros(2, np.float32), np.array([0.6, 0.0], np.float32)
MIDDLE = {"start": (0.0, 0.0, 0.0), "goal": (3.0, 1.0)}
LEVEL = (0.0, 0.0, 0.0, 1.0)


def expected_reward(before: dict[str, Any], now: dict[str, Any]) -> float:
    """RoboTerrain's reward, of two observations with the goal in the same place."""
    last, (distance, bearing) = float(before["target"][0]), map(float, now["target"])
    v, w = map(float, now["velocities"])
    if distance < 0.5:
        return 100.0
    if now["lidar"].min() < 0.3:
        return -0.5
    align = 1.0 - abs(bearing) / (math.pi / 2)  # 1 at 0 deg, 0 at 90, -1 at 180
    progress = last - distance
    d = 0.3 * progress if abs(progress) > 0.001 and 0.01 * align > 0.002 else -0.03
    return 1.5 * d + 0.0025 * v - 0.0015 * abs(w)


@pytest.mark.parametrize("stale", [False, True])
def test_the_reward_is_robo_terrains_of_what_is_observed(make: Make, stale: bool) -> None:
    env = make("RoboTerrain", defects={"stale_reward": stale})
    first, _ = env.reset(seed=3, options={**MIDDLE, "start": (0.0, 0.0, 2.5)})  # it looks away
    seen, rewards, expected = [first, first], [], []
    for action in [(0.7, 0.0)] * 8 + [(0.7, -2.5)] * 20 + [(0.7, 0.4)] * 8 + [(0.0, 0.0)] * 14:
        observation, reward, *_ = env.step(np.array(action, np.float32))
        seen.append(observation)
        rewards.append(reward)
        expected.append(expected_reward(*(seen[-3:-1] if stale else seen[-2:])))
    expected[0] = 0.0  # of the first step there is no progress
    assert rewards == pytest.approx(expected, abs=2e-7)  # what is observed is rounded to float32
    assert len({round(reward, 3) for reward in rewards}) > 3


def test_a_goal_is_worth_a_hundred_and_another_one_follows(make: Make) -> None:
    env = make("RoboTerrain")
    env.reset(seed=1, options={**MIDDLE, "goal": (0.6, 0.0)})
    seen: dict[str, Any] = {}
    rewards: list[float] = []
    goals = [env.goal]
    while not rewards or rewards[-1] < 50.0:
        seen, reward, terminated, truncated, info = env.step(AHEAD)
        rewards.append(reward)
        assert (terminated, truncated) == (False, False)
    assert rewards[-1] == 100.0
    assert (info["goals"], info["is_success"]) == (1, True)
    assert env.goal not in goals
    x, y, _ = env._pose.position
    away = pytest.approx(math.dist((x, y), env.goal), rel=1e-5)
    assert (seen["target"][0], info["distance"]) == (away, away)
    assert env.step(AHEAD)[1] == 0.0  # the first step towards it


def readings(ranges: np.ndarray) -> dict[type[Sample], Sample]:
    return {
        LaserScan: LaserScan(0, ranges.astype(np.float32)),
        Imu: Imu(0, LEVEL, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8)),
        Pose: Pose(0, (0.0, 0.0, 0.0), LEVEL),
        Odometry: Odometry(0, 0.0, 0.0, 0.0, Twist(0.1, 0.2)),
    }


@pytest.mark.parametrize(("defect", "too_near"), [(False, 0.0), (True, 12.0)])
def test_the_lidar_is_the_nearest_of_each_sector(make: Make, defect: bool, too_near: float) -> None:
    env = make("RoboTerrain", lidar_beams=64, defects={"nearest_is_farthest": defect})
    env.reset(seed=0)
    ranges = np.full(64, np.inf)
    ranges[:7] = 5.0, 4.0, np.nan, np.inf, -np.inf, np.inf, 9.0
    env._ride.readings = readings(ranges)
    lidar = env._observe(env._ride)["lidar"]
    assert lidar.tolist() == [4.0, 12.0, too_near, 9.0] + [12.0] * 28


@pytest.mark.parametrize(("uncounted", "counted"), [(False, 2), (True, 0)])
def test_scans_nearer_than_thirty_centimetres_are_collisions(
    make: Make, uncounted: bool, counted: int
) -> None:
    env = make("RoboTerrain", defects={"collisions_uncounted": uncounted})
    env.reset(seed=0, options=MIDDLE)
    rewards = []
    for nearest in (1.0, 0.29, 0.31, -np.inf):
        read = env._ride.read

        def near(read: Any = read, nearest: float = nearest) -> None:  # noqa: ANN401
            read()
            env._ride.readings = readings(np.full(32, nearest))

        env._ride.read = near
        _, reward, *_, info = env.step(STILL)
        env._ride.read = read
        rewards.append(reward)
    assert [reward == -0.5 for reward in rewards] == [False, True, False, True]
    assert info["reward_terms"] == {"collision": -0.5}
    assert info["collisions"] == counted


def test_the_heading_controller_is_pd_in_simulation_time(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    env = make("RoboTerrain")
    env.reset(seed=0)
    errors = [0.5, 0.7, 0.7, -0.1, 3.2]
    rates = [env._twist(np.array([0.4, error])).angular for error in errors]
    wrapped = [0.5, 0.7, 0.7, -0.1, 3.2 - math.tau]
    changes = np.diff([0.0, *wrapped])
    expected = 2.0 * np.array(wrapped) + 0.1 * changes / 0.05
    assert rates == pytest.approx(np.clip(expected, -7.0, 7.0))
    defective = make("RoboTerrain", defects={"wall_clock": True})
    now = iter([10.0, 10.5])
    monkeypatch.setattr("harness.gym.robo_terrain.time.perf_counter", lambda: next(now))
    defective.reset(seed=0)
    assert defective._twist(np.array([0.4, 0.5])).angular == pytest.approx(2.0 * 0.5 + 0.1 * 0.5 / 0.5)


@pytest.mark.parametrize(
    ("steps", "reward", "tilt"),
    [
        (1, 0.0, (0.78, 0.0)),
        (500, 0.0, (-0.75, 0.0)),
        (501, -20.0, (0.0, 0.75)),
        (502, -20.0, (0.0, -0.75)),
    ],
)
def test_who_flips_ends_and_pays_unless_it_was_early(
    make: Make, steps: int, reward: float, tilt: tuple[float, float]
) -> None:
    env = make("RoboTerrain")
    env.reset(seed=0, options=MIDDLE)
    env.steps = steps - 1
    half_roll, half_pitch = tilt  # beyond 0.74 rad; in the air
    cos, roll, pitch = math.cos(sum(tilt)), math.sin(half_roll), math.sin(half_pitch)
    env._ride.simulation.data.qpos[2:7] = 1.0, cos, roll, pitch, 0.0
    assert env.step(STILL)[1:3] == (reward, True)


def test_who_is_stuck_or_outside_ends_and_pays(make: Make) -> None:
    env = make("RoboTerrain", time_limit=40.0)
    env.reset(seed=0, options=MIDDLE)
    env._places.extend([(0.0, 0.0)] * 598)
    assert env.step(STILL)[2] is False  # 599
    _, reward, terminated, _, info = env.step(STILL)
    assert (reward, terminated, info["ending"]) == (-25.0, True, "stuck")
    env.reset(options=MIDDLE)
    env._ride.simulation.data.qpos[0] = 6.6
    _, reward, terminated, _, info = env.step(STILL)
    assert (reward, terminated, info["ending"]) == (-10.0, True, "edge")
    env.reset(options=MIDDLE)
    env._ride.simulation.data.qvel[0] = np.nan
    _, reward, terminated, _, info = env.step(STILL)
    assert (reward, terminated, info["ending"]) == (0.0, False, "diverged")


@pytest.mark.parametrize("defect", [False, True])
def test_the_time_limit_truncates_and_the_seed_decides_unless_asked_otherwise(
    make: Make, defect: bool
) -> None:
    env = make(
        "RoboTerrain", time_limit=0.05, defects={"limit_terminates": defect, "ignores_seed": defect}
    )
    infos = [env.reset(seed=0)[1] for _ in range(2)]
    starts, goals = ({tuple(info[name].tolist()) for info in infos} for name in ("start", "goal"))
    assert len(starts) == len(goals) == 1 + defect
    assert env.step(STILL)[2:4] == (defect, not defect)


def test_starts_and_goals_are_in_the_box_and_the_spaces_are_robo_terrains(make: Make) -> None:
    env = make("RoboTerrain", box=2.0, reverse_speed=0.6, goal_distance=(0.5, 9.0))
    places = []
    for seed in range(6):
        _, info = env.reset(seed=0 if seed == 0 else None)
        places += [*info["start"][:2], *info["goal"]]
    assert 1.0 < np.abs(places).max() <= 2.1
    limits = [*env.action_space.low, *env.action_space.high]
    assert limits == pytest.approx([-0.6, -math.pi, 1.0, math.pi])
    shapes = {name: box.shape for name, box in env.observation_space.items()}
    assert shapes == {"lidar": (32,), "pose": (3,), "imu": (3,), "target": (2,), "velocities": (2,)}
    assert (env.observation_space["pose"].high.tolist(), env.observation_space["lidar"].high[0]) == (
        [30.0, 30.0, 10.0],
        12.0,
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lidar_beams": 100}, "100 lidar_beams are not valid; give a multiple of 32"),
        ({"box": 0.0}, "box 0 is not valid; give a number above 0"),
        ({"reverse_speed": 2.0}, "reverse_speed 2 is not valid; give 0 to 1"),
        ({"defects": {"sleeps": True}}, "defects: key 'sleeps' does not exist; valid: limit_terminates"),
        ({"defects": {"stale_reward": 1}}, "stale_reward = 1 is not valid; give true or false"),
    ],
)
def test_its_own_options_are_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        ENVIRONMENTS["RoverHarness/RoboTerrain-v0"](**options)
