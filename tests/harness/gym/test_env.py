import importlib
import json
import math
import pickle
import re
import sys
import warnings
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.utils.env_checker import check_env

import harness.gym
from harness.config import FILE_OPTIONS, EpisodeConfig
from harness.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.gym.options import Options, parse_options
from harness.sim_time import NANOSECONDS
from harness.world.world import terrain_hash
from tests.harness.gym.conftest import SIDE, Make

AHEAD = np.array([1.0, 0.0], np.float32)
NAMES = [name.removeprefix("RoverHarness/").removesuffix("-v0") for name in ENVIRONMENTS]


@pytest.mark.parametrize("name", NAMES)
def test_gymnasiums_checker_has_nothing_to_say(make: Make, name: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if name == "RoboTerrain":  # whose actions are metres a second and radians, as they are there
            warnings.filterwarnings("ignore", ".*we recommend using a symmetric and normalized space")
        check_env(make(name), skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_stable_baselines3s_checker_has_nothing_to_say_either(make: Make, name: str) -> None:
    reason = "stable-baselines3 is not installed (examples/requirements-train.txt)"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what its own imports say
        checker = pytest.importorskip("stable_baselines3.common.env_checker", reason=reason)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if name == "RoboTerrain":  # as above
            warnings.filterwarnings("ignore", ".*We recommend you to use a symmetric and normalized")
        checker.check_env(make(name), skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_an_environment_survives_pickling_and_its_spec_a_file(small: dict[str, Any], name: str) -> None:
    env = gymnasium.make(f"RoverHarness/{name}-v0", **{**small, "randomisation": {"mass": [0.9, 1.1]}})
    assert env.spec is not None
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    seen = [e.reset(seed=4) for e in (env, again, pickle.loads(pickle.dumps(env.unwrapped)))]  # noqa: S301
    assert json.dumps(seen[0], default=np.ndarray.tolist) == json.dumps(
        seen[1], default=np.ndarray.tolist
    )
    assert json.dumps(seen[0], default=np.ndarray.tolist) == json.dumps(
        seen[2], default=np.ndarray.tolist
    )
    env.close()
    env.close()


def test_one_number_is_the_size_or_height_of_a_map_or_a_range(make: Make) -> None:
    options = make(terrain_size=12, terrain_height=2, goal_distance=3).options
    assert options.goal_distance == (3.0, 3.0)
    for terrain, size, height in ((options.terrain[0], (12.0, 12.0), 2.0), ("flat", None, None)):
        config = options.episode(terrain, 0, 0.5)
        assert (config.terrain_size, config.terrain_height) == (size, height)


def test_what_worlds_from_files_leave_open_is_told_as_on_the_command_line() -> None:
    given = {"terrain_cell": 0.2, "mesh_unit": "cm", "mesh_up": "y", "rock_height": 0}
    given |= {"resource_path": "models", "rock": "r*", "hazard": ["h", "i"]}
    options = parse_options(Options, {"terrain": ["a.sdf", "flat"], **given}, "here")
    lists = {"resource_path": ("models",), "rock": ("r*",), "hazard": ("h", "i")}
    config = options.episode("a.sdf", 0, 0.5)
    assert {name: getattr(config, name) for name in given} == given | lists
    assert options.episode("flat", 0, 0.5) == EpisodeConfig(terrain="flat")
    assert set(FILE_OPTIONS) == {*given, "terrain_size", "terrain_height"}
    with pytest.raises(UsageError, match="mesh unit 'league' does not exist; available: m, "):
        parse_options(Options, {"terrain": "a.sdf", "mesh_unit": "league"}, "here")


def test_the_world_of_a_seed_is_that_of_the_command_line() -> None:
    env: Any = gymnasium.make("RoverHarness/PointNav-v0", terrain="flat", random_start=False).unwrapped
    _, info = env.reset(seed=11)
    assert (info["terrain"], info["world_seed"], info["difficulty"]) == ("flat", 11, 0.5)
    assert info["start"].tolist() == [0.0, 0.0, 0.0]
    options = {"terrain": "gravel", "world_seed": 5, "difficulty": 0.25}
    _, info = env.reset(options=options)
    assert {key: info[key] for key in options} == options
    expected = EpisodeConfig(terrain="gravel", seed=5, difficulty=0.25).world()
    assert terrain_hash(env._course.scene.world) == terrain_hash(expected)


def test_worlds_are_kept_for_some_episodes_and_starts_and_goals_vary(make: Make) -> None:
    env = make(episodes_per_world=2, terrain=["flat", "slope"], difficulty=(0.2, 0.9))
    infos = [env.reset(seed=seed)[1] for seed in (1, None, None)]
    worlds = [(info["terrain"], info["world_seed"], info["difficulty"]) for info in infos]
    assert worlds[0] == worlds[1] != worlds[2]
    assert infos[2]["world_seed"] > 2**20  # one of 2^31, not of a few
    assert all(0.2 <= difficulty <= 0.9 for _, _, difficulty in worlds)
    assert len({tuple(info["start"]) for info in infos}) == 3
    for info in infos:
        assert 1.0 - 0.3 <= math.dist(info["start"][:2], info["goal"]) <= 4.0 + 0.3  # it may slide


def test_a_world_asked_for_by_any_of_its_properties_is_a_new_one(make: Make) -> None:
    env = make(episodes_per_world=100, terrain=["flat"])
    env.reset(seed=1)
    for key, value in {"terrain": "slope", "difficulty": 0.125, "world_seed": 77}.items():
        before = env._course
        assert env.reset(options={key: value})[1][key] == value
        assert env._course is not before


def test_success_makes_the_next_worlds_harder_until_a_seed_begins_anew(make: Make) -> None:
    env = make(difficulty=(0.0, 1.0), curriculum={"step": 0.25, "window": 1})
    here = {"options": {"start": (0.0, 0.0, 0.0), "goal": (0.2, 0.0)}}
    for highest in (0.25, 0.5):
        env.reset(seed=0 if highest == 0.25 else None, **here)
        assert env.step(AHEAD)[4]["is_success"]
        assert env._ladder.highest == highest
    env.reset(seed=0)
    assert env._ladder.highest == 0.0


def test_without_gymnasium_the_mend_is_told(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(UsageError, match=re.escape("pip install 'rover-harness[gym]'")):
        importlib.reload(harness.gym)
    monkeypatch.setattr(sys, "argv", ["-m"])  # as python -m has it while it loads the package
    with pytest.raises(SystemExit, match="2"):
        importlib.reload(harness.gym)
    assert capsys.readouterr().err.count("\n") == 1


def test_start_and_goal_can_be_given(make: Make) -> None:
    env = make()
    _, info = env.reset(seed=0, options={"start": (1.0, -2.0, 0.5), "goal": (2.0, 2.0)})
    assert (info["start"].tolist(), info["goal"].tolist()) == ([1.0, -2.0, 0.5], [2.0, 2.0])
    assert np.hypot(*(env._ride.simulation.position[:2] - np.array([1.0, -2.0]))) < 0.05
    assert env._ride.simulation.yaw == pytest.approx(0.5, abs=0.05)
    before_ns = env._ride.simulation.time_ns
    env.step(AHEAD)
    assert (env._ride.simulation.time_ns - before_ns) * env.metadata["render_fps"] == NANOSECONDS
    _, info = env.reset(options={"goal": (1.0, 1.0)})
    assert info["world_seed"] == 0  # no other world for another goal


WRONG_OPTIONS = [
    ({"terrain": "mars"}, "terrain 'mars' does not exist; available: flat, "),
    ({"terrain": []}, "terrain [] is empty; name at least one"),
    ({"robot": "curiosity"}, "robot 'curiosity' does not exist"),
    ({"colour": 1}, "PointNavEnv: key 'colour' does not exist; valid: robot, terrain"),
    ({"difficulty": (0.8, 0.2)}, "difficulty 0.8 to 0.2 is not valid; give two numbers from 0 up"),
    ({"difficulty": 1.5}, "difficulty 1.5 is not valid; give 0 to 1"),
    ({"difficulty": "hard"}, "difficulty = 'hard' is not valid; give a list of 2"),
    ({"noise": "loud"}, "noise preset 'loud' does not exist"),
    (
        {"randomisation": {"mass": (-1.0, 1.0)}},
        "randomisation: mass -1 to 1 is not valid; give two numbers above 0",
    ),
    ({"randomisation": {"latency": (0.0, math.inf)}}, "latency 0 to inf is not valid"),
    (
        {"randomisation": {"gravity": (1.0, 1.0)}},
        "randomisation: key 'gravity' does not exist; valid: friction",
    ),
    ({"curriculum": {"step": 2.0}}, "curriculum: step 2 is not valid; give 0 to 1"),
    ({"curriculum": {"window": 0}}, "curriculum: window 0 is not valid"),
    ({"episodes_per_world": 0}, "episodes_per_world 0 is not valid; give 1 or more"),
    ({"goal_distance": 0}, "goal_distance 0 to 0 is not valid; give two numbers above 0"),
    ({"time_limit": 0.003}, "duration 0.003 s is not valid"),
    ({"depth": (4,)}, "depth [4] is not valid; give width and height in pixels"),
    ({"depth": (0, 4)}, "an image of 0 x 4 pixels is not valid; give 1 or more"),
    ({"goal_radius": -1.0}, "goal_radius -1 is not valid; give a number above 0"),
    ({"terrain_size": [1.0, 2.0, 3.0]}, "terrain_size [1.0, 2.0, 3.0] is not valid; give 2 at most"),
    ({"render_mode": "ascii"}, "render_mode 'ascii' does not exist; available: rgb_array, human"),
]


@pytest.mark.parametrize(("options", "message"), WRONG_OPTIONS)
def test_options_that_are_not_valid_are_told_in_a_line(options: dict[str, Any], message: str) -> None:
    made = ENVIRONMENTS["RoverHarness/PointNav-v0"]
    with pytest.raises(UsageError, match=re.escape(message)) as raised:
        made(**options)
    assert "\n" not in str(raised.value)


WRONG_RESETS = [
    ({"wrold_seed": 3}, "reset: option 'wrold_seed' does not exist; did you mean 'world_seed'?"),
    ({"start": (1.0, 2.0)}, "reset: start (1.0, 2.0) is not valid; give 3 finite numbers"),
    ({"goal": ("a", "b")}, "reset: goal ('a', 'b') is not valid; give 2 finite numbers"),
    ({"goal": (math.nan, 0.0)}, "give 2 finite numbers"),
    ({"start": (5.0, 5.0, 0.0)}, "no rover can stand at start 5,5,0: it slid"),
    ({"start": (0.0, SIDE, 0.0)}, "is off the map or at its edge"),
    ({"terrain": "mars"}, "terrain 'mars' does not exist"),
]
WRONG_ACTIONS = [
    ([math.nan, 0.0], "action [nan, 0.0] is not valid; give finite numbers"),
    ([0.0, math.inf], "give finite numbers"),
    ([0.0], "an action of shape (1,) is not valid; give (2,)"),
    (0.5, "an action of shape () is not valid; give (2,)"),
]


def test_mistakes_with_an_episode_are_told_in_a_line_and_change_nothing(make: Make) -> None:
    env = make(time_limit=0.1)
    with pytest.raises(ResetNeeded, match="no episode to step; call reset"):
        env.step(AHEAD)
    env.reset(seed=0)
    for options, message in WRONG_RESETS:
        with pytest.raises(UsageError, match=re.escape(message)):
            env.reset(options=options)
    before, _ = env.reset(seed=0)
    for action, message in WRONG_ACTIONS:
        with pytest.raises(InvalidAction, match=re.escape(message)):
            env.step(np.array(action, np.float32))
    assert env.steps == 0
    first = env.step(AHEAD)
    assert first[2:4] == (False, False)
    assert not np.array_equal(first[0]["imu"], before["imu"])
    assert env.step(AHEAD)[2:4] == (False, True)  # 0.1 s are over
    with pytest.raises(ResetNeeded):
        env.step(AHEAD)


def test_actions_beyond_the_space_are_its_ends(make: Make) -> None:
    env, pairs = make(), [((1.0, -1.0), (50.0, -7.0)), ((-1.0, 1.0), (-3.0, 1.5))]
    for inside, beyond in pairs:
        seen = []
        for action in (inside, beyond):
            env.reset(seed=1)
            seen.append([env.step(np.array(action, np.float32))[1] for _ in range(3)])
        assert seen[0] == seen[1]
