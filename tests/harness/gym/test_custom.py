"""Rewards, endings and observations of one's own, images, and the steps of an episode."""

import math
import re
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import harness.gym  # noqa: F401 - registers the environments
from harness.base.errors import UsageError
from harness.gym.custom import Sight, StepTruth

ID = "RoverHarness/PointNav-v0"
FLAT: dict[str, Any] = {"terrain": "flat", "random_start": False, "lidar_beams": 16}


def calm(truth: StepTruth, action: Any) -> dict[str, float]:  # noqa: ANN401 - numpy's
    return {"progress": truth.progress, "effort": -float(np.abs(action).sum())}


def test_what_a_user_rewards_ends_and_sees_is_of_the_truth() -> None:
    place = Sight((-50.0,) * 3, (50.0,) * 3, lambda truth: (*truth.position[:2], truth.time_s))
    own: dict[str, Any] = {
        "reward_fn": calm,
        "observe_fn": place,
        "terminate_fn": lambda truth: truth.time_s > 0.9,
    }
    env = gymnasium.make(ID, **FLAT, **own)
    check_env(env.unwrapped, skip_render_check=True)
    seen, info = env.reset(seed=3)
    goal, steps, rewards, ended = info["goal"], 0, 0.0, False
    first = math.dist(goal, seen["own"][:2])
    while not ended:
        seen, reward, ended, _, info = env.step(np.array([1.0, 0.0], np.float32))
        steps, rewards = steps + 1, rewards + float(reward)
        assert info["reward_terms"].keys() == {"progress", "effort"}
        assert reward == pytest.approx(sum(info["reward_terms"].values()))
    assert (steps, info["ending"]) == (19, "own")
    assert seen["own"][2] == pytest.approx(0.95)
    # The progress of all steps is what the goal came nearer, and an effort of 1 a step.
    assert rewards == pytest.approx(first - math.dist(goal, seen["own"][:2]) - steps, abs=1e-4)


def test_an_episode_can_end_with_the_energy_of_its_motors() -> None:
    spent = list[float]()

    def is_empty(truth: StepTruth) -> bool:
        spent.append(truth.energy)
        return sum(spent) > 0.002

    env = gymnasium.make(ID, **FLAT, actuators="real", reward={"energy": -1.0}, terminate_fn=is_empty)
    env.reset(seed=3)
    ended, terms = False, list[float]()
    while not ended:
        _, _, ended, _, info = env.step(np.array([1.0, 0.0], np.float32))
        terms.append(info["reward_terms"]["energy"])
    assert (info["ending"], -np.array(terms).sum()) == ("own", pytest.approx(sum(spent)))


def test_progress_is_that_to_the_goal_of_the_step_also_where_another_follows() -> None:
    options = {**FLAT, "lidar_beams": 32, "reward_fn": calm}
    env = gymnasium.make("RoverHarness/RoboTerrain-v0", **options)
    env.reset(seed=1, options={"start": (0.0, 0.0, 0.0), "goal": (0.8, 0.0)})
    progress, info = list[float](), dict[str, Any](goals=0)
    while info["goals"] < 1 or len(progress) < 30:
        *_, info = env.step(np.array([0.6, 0.0], np.float32))
        progress.append(info["reward_terms"]["progress"])
    assert max(map(abs, progress)) < 0.05


@pytest.mark.parametrize(
    ("given", "reward"), [(2.5, 2.5), (np.float32(0.5), 0.5), ({"a": 1, "b": np.float64(0.5)}, 1.5)]
)
def test_a_reward_is_a_number_or_the_sum_of_its_terms(given: object, reward: float) -> None:
    env = gymnasium.make(ID, **FLAT, reward_fn=lambda *_: given)
    env.reset(seed=1)
    _, told, _, _, info = env.step(np.zeros(2, np.float32))
    assert told == reward == sum(info["reward_terms"].values())


@pytest.mark.parametrize(("given", "kind"), [(None, TypeError), ({"a": 1.0, "b": np.nan}, ValueError)])
def test_what_is_no_reward_is_named_with_its_value(given: object, kind: type[Exception]) -> None:
    env = gymnasium.make(ID, **FLAT, reward_fn=lambda *_: given)
    env.reset(seed=1)
    with pytest.raises(kind, match=re.escape(f"reward_fn gave {given!r}")):
        env.step(np.zeros(2, np.float32))


@pytest.mark.parametrize(("given", "kind"), [((1.0,), TypeError), ((0.0, np.nan), ValueError)])
def test_what_is_no_observation_is_named_with_its_value(
    given: tuple[float, ...], kind: type[Exception]
) -> None:
    env = gymnasium.make(ID, **FLAT, observe_fn=Sight((0.0, 0.0), (1.0, 1.0), lambda _: given))
    with pytest.raises(kind, match=re.escape(f"observe_fn gave {given!r}")):
        env.reset(seed=1)


def test_depth_and_heights_can_be_images_of_the_same_numbers() -> None:
    options = {**FLAT, "depth": (8, 6), "height_scan": True}
    flat, _ = gymnasium.make(ID, **options).reset(seed=1)
    env = gymnasium.make(ID, **options, images=True)
    images, _ = env.reset(seed=1)
    assert isinstance(env.observation_space, gymnasium.spaces.Dict)
    assert env.observation_space["depth"].shape == images["depth"].shape == (6, 8, 1)
    assert images["heights"].shape == (11, 7, 1)
    for name in ("depth", "heights"):
        np.testing.assert_array_equal(images[name].ravel(), flat[name])
    assert env.observation_space.contains(images)


def test_a_spec_tells_the_steps_of_an_episode() -> None:
    env = gymnasium.make(ID, **FLAT, time_limit=2.0)
    assert env.spec is not None
    assert env.spec.max_episode_steps == 40


@pytest.mark.parametrize(
    ("option", "said"),
    [
        ({"reward_fn": 3}, "reward_fn 3 is not valid; give a function"),
        ({"reward_fn": "none"}, "reward_fn 'none' does not exist"),
        ({"terminate_fn": "none"}, "terminate_fn 'none' does not exist"),
        ({"observe_fn": calm}, "is not valid; give a harness.gym.custom.Sight"),
    ],
)
def test_what_is_no_function_is_told(option: dict[str, Any], said: str) -> None:
    with pytest.raises(UsageError, match=said):
        gymnasium.make(ID, **FLAT, **option)
