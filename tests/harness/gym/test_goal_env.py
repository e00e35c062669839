from typing import Any

import numpy as np
import pytest

from harness.samples import Pose
from tests.harness.gym.conftest import Make


def test_a_step_is_judged_by_the_goals_that_are_observed_to_the_bit(make: Make) -> None:
    env, rng = make("PointNavGoal", goal_radius=0.75), np.random.default_rng(0)
    outcomes, places = list[str](), list[Any]()
    env.reset(seed=1, options={"start": (0.0, 0.0, 0.0), "goal": (4.0, 0.0)})
    for angle in rng.uniform(-np.pi, np.pi, 100):
        x, y, _ = env.driven.readings[Pose].position
        env.goal = x + 0.75 * np.cos(angle), y + 0.75 * np.sin(angle)  # but for the last bits
        seen, reward, terminated, _, info = env.step(np.zeros(2, np.float32))
        goals = seen["achieved_goal"], seen["desired_goal"]
        apart = np.linalg.norm(np.subtract(*(goal.astype(float) for goal in goals)))
        assert info["distance"] == pytest.approx(apart, rel=1e-15)
        assert env.compute_reward(*goals, None) == reward == (0.0 if terminated else -1.0)
        assert env.compute_terminated(*goals, {}) is terminated is info["is_success"]
        assert "reward_terms" not in info
        outcomes.append(info["ending"])
        places.append(goals[0])
        if info["ending"]:
            env.reset(options={"start": (0.0, 0.0, 0.0), "goal": (4.0, 0.0)})
    assert {*outcomes} == {"", "reached"}
    assert env.compute_reward(np.array([0.75, 0.0]), np.zeros(2), None) == -1.0  # within, not at
    hindsight = np.linspace(0.0, 2.0, 300)[:, None] * [0.6, 0.8] + places[4]  # many at once
    batch = env.compute_reward(hindsight, np.tile(places[4], (300, 1)), None)
    assert batch.tolist() == [0.0 if 2.0 * n / 299 < 0.75 else -1.0 for n in range(300)]


@pytest.mark.parametrize(
    ("ending", "terminated", "truncated"),
    [
        *[("", False, False), ("hazard", True, False), ("flipped", True, False), ("time", False, True)],
        *[("edge", False, True), ("diverged", False, True)],
        ("reached", False, False),  # of another goal
        (None, False, False),
    ],
)
def test_what_ends_an_episode_for_another_reason_still_does(
    make: Make, ending: str | None, terminated: bool, truncated: bool
) -> None:
    env, here, far = make("PointNavGoal"), np.zeros(2), np.ones(2)
    info = {} if ending is None else {"ending": ending}
    assert env.compute_terminated(here, far, info) is terminated
    assert env.compute_truncated(here, far, info) is truncated


def test_the_heading_and_what_point_nav_observes_follow_one_another(make: Make) -> None:
    env, plain = make("PointNavGoal", height_scan=True), make(height_scan=True)
    options = {"start": (1.0, 0.5, 2.0), "goal": (3.0, 1.0)}
    (seen, _), (expected, _) = (e.reset(seed=5, options=options) for e in (env, plain))
    names = ("lidar", "imu", "velocities", "heights")
    parts = [expected[name] for name in names]
    for end, of_heading in (("low", [-1.0, -1.0]), ("high", [1.0, 1.0])):
        limits = [getattr(plain.observation_space[name], end) for name in names]
        assert (
            getattr(env.observation_space["observation"], end).tolist()
            == np.concatenate([*limits, of_heading]).tolist()
        )
    assert expected["heights"].shape == (77,)
    assert seen["observation"][:-2].tolist() == np.concatenate(parts).tolist()
    assert np.arctan2(*seen["observation"][-2:]) == pytest.approx(2.0, abs=0.02)
    assert seen["achieved_goal"] == pytest.approx([1.0, 0.5], abs=0.02)
    assert seen["desired_goal"].tolist() == [3.0, 1.0]
