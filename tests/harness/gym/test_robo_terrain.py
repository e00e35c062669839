import math
import re
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.gym.driven_rover import DrivenRover
from harness.samples import Imu, LaserScan, Odometry, Pose, Twist
from tests.harness.gym.conftest import Make, place

STILL, AHEAD = np.zeros(2, np.float32), np.array([0.6, 0.0], np.float32)
MIDDLE = {"start": (0.0, 0.0, 0.0), "goal": (3.0, 1.0)}


def expected_terms(
    before: float | None, way: tuple[float, float], near: float, v: float, w: float
) -> dict[str, float]:
    """RoboTerrain's reward: distance before and way to the goal, nearest range, speed, yaw rate."""
    distance, bearing = way
    if before is None:
        return {}
    if distance < 0.5:
        return {"goal": 100.0}
    if near < 0.3:
        return {"collision": -0.5}
    align = 1.0 - abs(bearing) / (math.pi / 2)  # 1 at 0 deg, 0 at 90, -1 at 180
    progress = before - distance
    d = 0.3 * progress if abs(progress) > 0.001 and 0.01 * align > 0.002 else -0.03
    return {"distance": 1.5 * d, "speed": 0.0025 * v, "turn": -0.0015 * abs(w)}


def way(goal: tuple[float, float], pose: Pose) -> tuple[float, float]:
    """Distance and bearing of a goal."""
    east, north = np.subtract(goal, pose.position[:2])
    yaw = Rotation.from_quat(pose.orientation).as_euler("ZYX")[0]
    bearing = (math.atan2(north, east) - yaw + math.pi) % math.tau - math.pi
    return math.hypot(east, north), bearing


@pytest.mark.parametrize("defect", [False, True])
def test_steps_are_observed_and_paid_as_robo_terrain_does_wherever_it_is(
    make: Make, defect: bool
) -> None:
    defects = {"nearest_is_farthest": defect, "collisions_uncounted": defect}
    env = make("RoboTerrain", lidar_beams=64, defects=defects)
    rng, before, goals, collisions = np.random.default_rng(0), None, 0, 0
    paid: set[str] = set()
    env.reset(seed=3, options=MIDDLE)
    pose = env.driven.readings[Pose]
    for _ in range(400):
        # Anywhere, at any tilt at which it does not count as flipped, the goal where rules change.
        tilt = rng.uniform(-1.4, 1.4, 2) * (rng.random(2) < 0.3)
        place(env, rng.uniform(-2.0, 2.0, 2), rng.uniform(0.12, 0.5), (rng.uniform(-3.0, 3.0), *tilt))
        angle = rng.uniform(-math.pi, math.pi)
        away = rng.choice([0.48, 0.52, rng.uniform(0.6, 8.0)], p=[0.05, 0.05, 0.9])
        if before is not None and rng.random() < 0.5:
            away = before + rng.choice([-0.0015, -0.0005, 0.0005, 0.0015])
        x, y = env.driven.simulation.position[:2] + away * np.array([math.cos(angle), math.sin(angle)])
        env.goal = goal = (float(x), float(y))
        seen, reward, terminated, truncated, info = env.step(
            rng.uniform([-1.0, -3.0], [1.0, 3.0]).astype("f4")
        )
        if info["ending"] == "flipped":
            env.reset(options=MIDDLE)
            before = None
            goals = collisions = 0
            continue
        assert (terminated, truncated) == (False, False)
        readings = env.driven.readings
        pose, twist, ranges = readings[Pose], readings[Odometry].twist, readings[LaserScan].ranges
        ranges = np.where(np.isneginf(ranges), 12.0 if defect else 0.0, np.fmin(ranges, 12.0))
        sectors = ranges.reshape(32, 2).min(axis=1)
        yaw, pitch, roll = Rotation.from_quat(readings[Imu].orientation).as_euler("ZYX")
        assert seen["lidar"] == pytest.approx(sectors)
        assert seen["pose"] == pytest.approx(pose.position)
        assert seen["imu"] == pytest.approx((pitch, roll, yaw), abs=1e-5)
        assert seen["velocities"] == pytest.approx((twist.linear, twist.angular))
        assert seen["target"] == pytest.approx(way(env.goal, pose), abs=1e-5)
        assert info["distance"] == pytest.approx(way(env.goal, pose)[0])
        nearest, there = float(sectors.min()), way(goal, pose)
        terms = expected_terms(before, there, nearest, twist.linear, twist.angular)
        assert info["reward_terms"] == pytest.approx(terms, abs=1e-9)
        assert reward == pytest.approx(sum(terms.values()), abs=1e-9)
        goals, collisions = goals + ("goal" in terms), collisions + ("collision" in terms)
        counts = info["goals"], info["collisions"], info["is_success"]
        assert counts == (goals, 0 if defect else collisions, goals > 0)
        assert (env.goal == goal) != ("goal" in terms)
        if "collision" not in terms:  # which leaves the distance before it in force
            before = None if "goal" in terms else there[0]
        paid |= terms.keys()
    assert paid == {"goal", "collision", "distance", "speed", "turn"}


def test_a_stale_reward_is_that_of_the_observation_before(make: Make) -> None:
    told: list[list[float]] = []
    for stale in (False, True):
        env = make("RoboTerrain", defects={"stale_reward": stale})
        env.reset(seed=3, options={**MIDDLE, "start": (0.0, 0.0, 2.5)})  # it looks away
        actions = [(0.7, 0.0)] * 8 + [(0.7, -2.5)] * 20 + [(0.7, 0.4)] * 8 + [(0.0, 0.0)] * 14
        told.append([env.step(np.array(action, np.float32))[1] for action in actions])
    prompt, late = told
    assert late[0] == prompt[0] == 0.0  # of the first step there is no progress
    assert late[2:] == prompt[1:-1]
    assert late[1] != 0.0
    assert len({round(reward, 3) for reward in prompt}) > 3


def test_the_heading_controller_is_pd_in_simulation_time(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    twists: list[Twist] = []
    command = DrivenRover.command

    def record(driven: DrivenRover, twist: Twist) -> None:
        twists.append(twist)
        command(driven, twist)

    monkeypatch.setattr(DrivenRover, "command", record)
    env = make("RoboTerrain")
    speeds, errors = [0.4, -0.4, 0.0, 1.0, -1.0, 0.5], [0.5, 0.7, 0.7, -0.1, -3.1, 3.0]
    for _ in range(2):  # the second episode knows nothing of the first
        env.reset(seed=0)
        twists.clear()
        for action in zip(speeds, errors, strict=True):
            env.step(np.array(action))
        assert [twist.linear for twist in twists] == speeds
        expected = 2.0 * np.array(errors) + 0.1 * np.diff([0.0, *errors]) / 0.05
        assert [twist.angular for twist in twists] == pytest.approx(np.clip(expected, -7.0, 7.0))
    now = iter([10.0, 10.5])
    monkeypatch.setattr("harness.gym.robo_terrain.time.perf_counter", lambda: next(now))
    defective = make("RoboTerrain", defects={"wall_clock": True})
    defective.reset(seed=0)
    defective.step(np.array([0.4, 0.5]))
    assert twists[-1].angular == pytest.approx(2.0 * 0.5 + 0.1 * 0.5 / 0.5)


@pytest.mark.parametrize(
    ("steps", "tilt", "x", "speed", "reward", "ending"),
    [
        (500, (1.52, 0.0), 0.0, 0.0, 0.0, "flipped"),  # early
        (501, (0.0, 1.52), 0.0, 0.0, -20.0, "flipped"),
        (501, (0.0, -1.52), 0.0, 0.0, -20.0, "flipped"),
        (501, (1.44, 0.0), 0.0, 0.0, None, ""),
        (501, (0.0, -1.44), 0.0, 0.0, None, ""),
        (1, None, 6.6, 0.0, -10.0, "edge"),
        (1, None, 0.0, math.nan, 0.0, "diverged"),
    ],
)
def test_who_flips_leaves_or_diverges_ends_and_pays(
    make: Make,
    steps: int,
    tilt: tuple[float, float] | None,
    x: float,
    speed: float,
    reward: float | None,
    ending: str,
) -> None:
    env = make("RoboTerrain")
    env.reset(seed=0, options=MIDDLE)
    if tilt is not None:
        place(env, (0.0, 0.0), 2.0, (0.0, tilt[1], tilt[0]))  # in the air, where it keeps its attitude
    env.driven.simulation.data.qpos[0] += x
    env.driven.simulation.data.qvel[0] = speed
    env.steps = steps - 1
    _, paid, terminated, truncated, info = env.step(STILL)
    assert (info["ending"], terminated) == (ending, ending in ("flipped", "edge"))
    assert truncated == (ending == "diverged")
    assert reward is None or paid == reward


@pytest.mark.parametrize(
    ("back", "steps", "ending"), [(None, 600, "stuck"), (0.0, 600, "stuck"), (0.003, 601, "")]
)
def test_who_is_after_600_steps_where_it_was_is_stuck(
    make: Make, back: float | None, steps: int, ending: str
) -> None:
    env = make("RoboTerrain")
    env.reset(seed=0, options=MIDDLE)
    home = env.driven.simulation.data.qpos.copy()
    for step in range(1, steps + 1):
        away = 0.0 if back is None or step <= 2 else (1.0 if step < steps - 2 else back)
        data = env.driven.simulation.data
        data.qpos[:], data.qvel[:] = home, 0.0
        data.qpos[0] += away
        _, reward, terminated, _, info = env.step(STILL)
        assert terminated == (step == steps and bool(ending)), step
    assert info["ending"] == ending
    assert (reward == -25.0) == bool(ending)


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


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lidar_beams": 100}, "100 lidar_beams are not valid; give a multiple of 32"),
        ({"box": 0.0}, "box 0.0 is not valid; give more than 0"),
        ({"reverse_speed": 2.0}, "reverse_speed 2.0 is not valid; give 0 to 1"),
        ({"defects": {"sleeps": True}}, "defects: key 'sleeps' does not exist"),
    ],
)
def test_its_own_options_are_checked(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        ENVIRONMENTS["RoverHarness/RoboTerrain-v0"](**options)
