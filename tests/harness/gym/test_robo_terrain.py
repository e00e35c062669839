import math
import re
from types import SimpleNamespace
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist
from tests.harness.gym.conftest import Make

STILL, AHEAD = np.zeros(2, np.float32), np.array([0.6, 0.0], np.float32)
MIDDLE = {"start": (0.0, 0.0, 0.0), "goal": (3.0, 1.0)}


def expected_terms(before: dict[str, Any], now: dict[str, Any]) -> dict[str, float]:
    """RoboTerrain's reward, of two observations with the goal in the same place."""
    last, (distance, bearing) = float(before["target"][0]), map(float, now["target"])
    v, w = map(float, now["velocities"])
    if distance < 0.5:
        return {"goal": 100.0}
    if now["lidar"].min() < 0.3:
        return {"collision": -0.5}
    align = 1.0 - abs(bearing) / (math.pi / 2)  # 1 at 0 deg, 0 at 90, -1 at 180
    progress = last - distance
    d = 0.3 * progress if abs(progress) > 0.001 and 0.01 * align > 0.002 else -0.03
    return {"distance": 1.5 * d, "speed": 0.0025 * v, "turn": -0.0015 * abs(w)}


@pytest.mark.parametrize("stale", [False, True])
def test_the_reward_is_robo_terrains_of_what_is_observed(make: Make, stale: bool) -> None:
    env = make("RoboTerrain", defects={"stale_reward": stale})
    first, _ = env.reset(seed=3, options={**MIDDLE, "start": (0.0, 0.0, 2.5)})  # it looks away
    seen, rewards, expected = [first, first], [], []
    for action in [(0.7, 0.0)] * 8 + [(0.7, -2.5)] * 20 + [(0.7, 0.4)] * 8 + [(0.0, 0.0)] * 14:
        observation, reward, *_ = env.step(np.array(action, np.float32))
        seen.append(observation)
        rewards.append(reward)
        terms = expected_terms(*(seen[-3:-1] if stale else seen[-2:]))
        expected.append(sum(terms.values()))
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
    _, reward, *_, info = env.step(AHEAD)
    assert (reward, info["goals"], info["is_success"]) == (0.0, 1, True)  # the first step towards it


def sensed(
    x: float = 0.0,
    yaw: float = 0.0,
    *,
    tilt: tuple[float, float] = (0.0, 0.0),
    twist: Twist = Twist(),  # noqa: B008 - frozen
    ranges: float | np.ndarray = 9.0,
) -> Any:  # noqa: ANN401
    """What is read of a ride that stands east of the origin [m], rolled and pitched [rad]."""
    turned, level = (
        tuple(Rotation.from_euler("ZYX", angles).as_quat().tolist())
        for angles in ((yaw + 0.3, *tilt[::-1]), (yaw, 0.0, 0.0))  # an IMU's yaw drifts
    )
    samples: tuple[Sample, ...] = (
        LaserScan(0, np.broadcast_to(ranges, 64).astype(np.float32)),
        Imu(0, turned, (0.0, 0.0, 0.0), (0.0, 0.0, 9.8)),
        Pose(0, (x, 0.25, 0.5), level),
        Odometry(0, 0.0, 0.0, 0.0, twist),
    )
    return SimpleNamespace(readings={type(sample): sample for sample in samples})


def begun(make: Make, goal: tuple[float, float] = (3.0, 0.25), **defects: bool) -> Any:  # noqa: ANN401
    """An environment that is fed with what is sensed, and had another episode before."""
    env = make("RoboTerrain", lidar_beams=64, defects=defects)
    env._draw_goal = Mock(side_effect=[(2.0, 0.25), (9.0, 9.0)])
    env.goal, env.steps = (0.1, 0.25), 0
    env._begin(None)
    for x in (0.8, 0.5, 2.1, 1.9):
        env._twist([0.0, 1.0])
        judged(env, sensed(x))
    assert (env.goal, env._told()["goals"]) == ((9.0, 9.0), 2)
    env.goal, env.steps = goal, 0
    env._begin(None)
    return env


def judged(env: Any, ride: Any, failure: str = "") -> tuple[float, str, dict[str, Any]]:  # noqa: ANN401
    if not failure:
        env._seen = env._observe(ride)
    env.steps += 1
    told: tuple[float, str, dict[str, Any]] = env._judge(ride, failure)
    return told


@pytest.mark.parametrize(("defect", "too_near"), [(False, 0.0), (True, 12.0)])
def test_what_is_observed_is_what_was_sensed_and_of_the_lidar_the_nearest_of_each_sector(
    make: Make, defect: bool, too_near: float
) -> None:
    env = begun(make, (1.5, 1.25), nearest_is_farthest=defect)
    ranges = np.full(64, np.inf)
    ranges[:7] = 5.0, 4.0, np.nan, np.inf, -np.inf, np.inf, 9.0
    seen = env._observe(sensed(0.5, 2.0, tilt=(0.1, -0.2), twist=Twist(0.3, -0.4), ranges=ranges))
    assert seen["lidar"].tolist() == [4.0, 12.0, too_near, 9.0] + [12.0] * 28
    assert seen["pose"] == (0.5, 0.25, 0.5)
    assert seen["imu"] == pytest.approx((-0.2, 0.1, 2.3))  # pitch comes first
    assert seen["target"] == pytest.approx((math.sqrt(2.0), math.pi / 4 - 2.0))
    assert seen["velocities"] == (0.3, -0.4)


def test_every_step_is_paid_as_robo_terrain_pays_it(make: Make) -> None:
    env, rng, paid = begun(make), np.random.default_rng(0), set()
    env._draw_goal = Mock(return_value=(9.0, 9.0))
    for n in range(200):
        distance = rng.choice([0.4999, 0.5, 0.5001, rng.uniform(0.6, 8.0)], p=[0.05, 0.05, 0.05, 0.85])
        nearest = rng.choice([0.2999, 0.3001, 0.4, 9.0])
        progress = rng.choice([-0.0011, -0.0009, 0.0009, 0.0011, rng.uniform(-0.04, 0.04)])
        bearing = rng.choice([1.0, -1.0]) * rng.choice([1.25, 1.26, rng.uniform(0.0, math.pi)])  # 72 deg
        twist = Twist(*rng.uniform(-1.0, 1.0, 2).tolist())
        ahead = math.radians(90.0 * rng.integers(-1, 2))
        env.goal = (0.0, 0.25)
        env._begin(None)
        steps = [
            (sensed(away, math.pi - angle, twist=twist, ranges=nearest), away, angle)
            for away, angle in ((distance + progress, ahead), (distance, bearing))
        ]
        rewards = [judged(env, ride)[0] for ride, _, _ in steps]
        info = env._told()
        seen = {"lidar": np.array([nearest]), "velocities": (twist.linear, twist.angular)}
        before, now = ({"target": (away, angle), **seen} for _, away, angle in steps)
        terms = expected_terms(before, now)
        expected = sum(terms.values())
        case = distance, nearest, progress, bearing
        assert rewards == [0.0, pytest.approx(expected, abs=1e-12)], case
        assert info["reward_terms"] == pytest.approx(terms, abs=1e-12)
        assert (info["goals"], info["collisions"]) == (expected == 100.0, expected == -0.5)
        assert info["is_success"] == (expected == 100.0)
        if expected == 100.0:
            env._draw_goal.assert_called_with((distance, 0.25))
            env._draw_goal = Mock(return_value=(n, n))
        paid.add(round(expected, 1))
    assert paid >= {100.0, -0.5, 0.0}


def test_collisions_are_counted_unless_asked_otherwise(make: Make) -> None:
    for uncounted, counts in ((False, [0, 1, 1, 2]), (True, [0] * 4)):
        env = begun(make, collisions_uncounted=uncounted)
        told = [judged(env, sensed(ranges=nearest)) for nearest in (1.0, 0.29, 0.31, -np.inf)]
        assert [reward == -0.5 for reward, _, _ in told] == [False, True, False, True]
        assert [info["collisions"] for _, _, info in told] == counts


def test_the_heading_controller_is_pd_in_simulation_time(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    env = begun(make)
    errors = [0.5, 0.7, 0.7, -0.1, 3.2, 3.0]
    speeds = [0.4, -0.4, 0.0, 1.0, -1.0, 0.5]
    twists = [env._twist([speed, error]) for speed, error in zip(speeds, errors, strict=True)]
    rates = [twist.angular for twist in twists]
    assert [twist.linear for twist in twists] == speeds
    wrapped = [0.5, 0.7, 0.7, -0.1, 3.2 - math.tau, 3.0]
    changes = np.diff([0.0, *wrapped])
    expected = 2.0 * np.array(wrapped) + 0.1 * changes / 0.05
    assert rates == pytest.approx(np.clip(expected, -7.0, 7.0))
    defective = make("RoboTerrain", defects={"wall_clock": True})
    now = iter([10.0, 10.5])
    monkeypatch.setattr("harness.gym.robo_terrain.time.perf_counter", lambda: next(now))
    defective._begin(None)
    assert defective._twist(np.array([0.4, 0.5])).angular == pytest.approx(2.0 * 0.5 + 0.1 * 0.5 / 0.5)


@pytest.mark.parametrize("failure", ["", "edge", "diverged"])
@pytest.mark.parametrize(
    ("steps", "tilt", "reward", "ending"),
    [
        (1, (1.481, 0.0), 0.0, "flipped"),
        (500, (-1.481, 0.0), 0.0, "flipped"),
        (501, (0.0, 1.481), -20.0, "flipped"),
        (501, (0.0, -1.481), -20.0, "flipped"),
        (501, (3.0, 0.0), -20.0, "flipped"),
        (501, (1.479, 0.0), 0.0, ""),
        (501, (0.0, -1.479), 0.0, ""),
    ],
)
def test_who_flips_ends_and_pays_unless_it_was_early(
    make: Make, steps: int, tilt: tuple[float, float], reward: float, ending: str, failure: str
) -> None:
    env = begun(make)
    env._observe(sensed(tilt=tilt))
    env.steps = steps - 1
    expected = (reward, ending) if ending or not failure else (-10.0, "edge")
    if failure == "diverged":
        expected = 0.0, "diverged"
    assert judged(env, sensed(tilt=tilt), failure)[:2] == expected
    assert env.terminal_endings == {"flipped", "stuck", "edge"}


@pytest.mark.parametrize(
    ("places", "ending"),
    [
        ([0.0] * 599, ""),
        ([0.0] * 600, "stuck"),
        ([0.0] + [1.0] * 598 + [0.0009], "stuck"),  # there and back
        ([0.0] + [1.0] * 598 + [-0.0011], ""),
        ([0.0] + [1.0] * 599 + [0.0], ""),  # of the last 600 only
        ([1.0] + [0.0] * 600, "stuck"),
    ],
)
def test_who_is_after_600_steps_where_it_was_is_stuck(
    make: Make, places: list[float], ending: str
) -> None:
    env = begun(make)
    env._places.extend([(0.0, 0.25)] * 600)  # in the episode before
    env._begin(None)
    judged(env, sensed(-2.0))
    assert len(env._places) == 1
    env._places.clear()
    env._places.extend((x, 0.25) for x in places[:-1])
    reward, told, _ = judged(env, sensed(places[-1]))
    assert told == ending
    assert (reward == -25.0) if ending else (abs(reward) < 2.0)


@pytest.mark.parametrize("defect", [False, True])
def test_the_time_limit_truncates_and_the_seed_decides_unless_asked_otherwise(
    make: Make, defect: bool
) -> None:
    defects = {"limit_terminates": defect, "ignores_seed": defect}
    env = make("RoboTerrain", time_limit=0.05, defects=defects)
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
    assert make("RoboTerrain", reverse_speed=0.0).action_space.low[0] == 0.0
    limits = [*env.action_space.low, *env.action_space.high]
    assert limits == pytest.approx([-0.6, -math.pi, 1.0, math.pi])
    shapes = {name: box.shape for name, box in env.observation_space.items()}
    assert shapes == {"lidar": (32,), "pose": (3,), "imu": (3,), "target": (2,), "velocities": (2,)}
    assert env.observation_space["pose"].high.tolist() == [30.0, 30.0, 10.0]
    assert env.observation_space["lidar"].high[0] == 12.0


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lidar_beams": 100}, "100 lidar_beams are not valid; give a multiple of 32"),
        ({"time_limit": 0.003}, "duration 0.003 s is not valid"),
        ({"box": 0.0}, "box 0.0 is not valid; give more than 0"),
        ({"box": math.inf}, "box inf is not valid; give a finite number"),
        ({"reverse_speed": -0.1}, "reverse_speed -0.1 is not valid; give 0 to 1"),
        ({"reverse_speed": 2.0}, "reverse_speed 2.0 is not valid; give 0 to 1"),
        (
            {"defects": {"sleeps": True}},
            "defects: key 'sleeps' does not exist",
        ),
    ],
)
def test_its_own_options_are_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        ENVIRONMENTS["RoverHarness/RoboTerrain-v0"](**options)
