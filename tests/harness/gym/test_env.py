import gc
import importlib
import json
import math
import pickle
import re
import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from scipy.spatial.transform import Rotation

import harness.gym
from harness.base.errors import RunFailed, UsageError
from harness.episode.assembly import world_of
from harness.gym import ENVIRONMENTS, observation
from harness.gym.observation import (
    LEFT,
    Limits,
    height_part,
    heights_around,
    point_nav_parts,
    space_of,
)
from harness.gym.options import Curriculum, CurriculumSchedule, Options, parse_options
from harness.samples import Pose
from harness.spec.run import Run
from harness.spec.world import FILE_FIELDS
from harness.world.heightfield import Heightfield
from harness.world.world import terrain_hash
from tests.harness.gym.conftest import SIDE, Make
from tests.support.documents import ROOT

AHEAD = np.array([1.0, 0.0], np.float32)
NAMES = [name.removeprefix("RoverHarness/").removesuffix("-v0") for name in ENVIRONMENTS]
NAMED = {"terrain_size": None, "random_start": False}  # for terrains that are no files


def as_json(told: object) -> str:
    return json.dumps(told, default=np.ndarray.tolist)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("checker", ["gymnasium.utils", "stable_baselines3.common"])
def test_gymnasiums_checker_and_stable_baselines3s_have_nothing_to_say(
    make: Make, checker: str, name: str
) -> None:
    reason = "stable-baselines3 is not installed (extra [train])"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what its own imports say
        check_env = pytest.importorskip(f"{checker}.env_checker", reason=reason).check_env
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if name == "RoboTerrain":  # whose actions are metres a second and radians, as they are there
            warnings.filterwarnings("ignore", "(?i).*we recommend .* a symmetric and normalized")
        check_env(make(name), skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_pickles_and_specs_from_files_make_the_same_episodes(small: dict[str, Any], name: str) -> None:
    more = {"randomisation": {"mass": [0.9, 1.1]}, "render_mode": "rgb_array"}
    env = gymnasium.make(f"RoverHarness/{name}-v0", **{**small, **more})
    assert env.spec is not None
    assert env.unwrapped.render_mode == "rgb_array"
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    seen = [e.reset(seed=4) for e in (env, again, pickle.loads(pickle.dumps(env.unwrapped)))]  # noqa: S301
    assert as_json(seen[0]) == as_json(seen[1]) == as_json(seen[2])
    env.close()
    env.close()


@pytest.mark.parametrize("name", NAMES)
def test_a_seed_begins_the_same_episodes_whatever_was_before(make: Make, name: str) -> None:
    env = make(name, noise="hardware", randomisation={"payload": (0.0, 3.0)}, episodes_per_world=2)
    rounds = []
    for _ in range(2):
        episodes = [env.reset(seed=6), env.step(AHEAD), env.reset(), env.step(AHEAD), env.reset()]
        rounds.append([as_json(told) for told in episodes])
        env.step(-AHEAD)
    assert rounds[0] == rounds[1]
    assert len({*rounds[0]}) == 5
    still = {"start": (0.0, 0.0, 0.0), "goal": (1.0, 1.0)}
    sensed = [env.reset(seed=seed, options=still)[0] for seed in (1, None, None, 2)]
    assert len({as_json(seen) for seen in sensed}) == 4, "each episode has noise of its own"


def test_worlds_are_drawn_and_stay_for_their_episodes(make: Make) -> None:
    env = make(terrain=["flat", "gravel"], difficulty=(0.2, 0.6), episodes_per_world=2, **NAMED)
    infos = [env.reset(seed=seed)[1] for seed in (5, *[None] * 23)]
    worlds = [(info["terrain"], info["world_seed"], info["difficulty"]) for info in infos]
    assert worlds[::2] == worlds[1::2]
    assert len({seed for _, seed, _ in worlds}) == len(worlds) // 2
    assert worlds[0][1] == 5
    assert max(seed for _, seed, _ in worlds) > 2**28
    assert 2 < [terrain for terrain, _, _ in worlds[::2]].count("flat") < 10
    difficulties = sorted(difficulty for _, _, difficulty in worlds)
    assert 0.2 <= difficulties[0] < 0.3
    assert 0.5 < difficulties[-1] <= 0.6


def test_the_world_of_a_seed_is_that_of_the_command_line(make: Make) -> None:
    env = make(terrain="flat", **NAMED)
    _, info = env.reset(seed=11)
    assert (info["terrain"], info["world_seed"], info["difficulty"]) == ("flat", 11, 0.5)
    assert info["start"].tolist() == [0.0, 0.0, 0.0]
    asked: dict[str, Any] = {"terrain": "gravel", "difficulty": 0.0, "world_seed": 0}
    for name, value in asked.items():  # each for itself is a new world, a goal is none
        before = env.course
        assert env.reset(options={name: value})[1][name] == value
        assert env.course is not before
        env.reset(options={"goal": (1.0, 1.0)})
        assert env.reset()[1][name] == value
    env.reset(options={"terrain": "gravel", "world_seed": 5, "difficulty": 0.25})
    expected = world_of(Run.of(terrain="gravel", seed=5, difficulty=0.25))
    assert terrain_hash(env.course.scene.world) == terrain_hash(expected)


@pytest.mark.parametrize(("name", "box"), [("PointNav", math.inf), ("RoboTerrain", 2.0)])
def test_starts_goals_and_variations_are_drawn_and_reported(make: Make, name: str, box: float) -> None:
    own = {"box": box} if box < math.inf else {}
    env = make(name, goal_distance=(1.0, 2.0), randomisation={"payload": (0.0, 4.0)}, **own)
    env.reset(seed=0)
    plain = env.course.scene.model.body_subtreemass[1]
    payloads, yaws, apart = [], [], []
    for _ in range(60):
        _, info = env.reset()
        simulation = env.driven.simulation
        x, y, _ = simulation.position
        assert env.goal == tuple(info["goal"])
        assert (x, y, simulation.yaw) == pytest.approx(tuple(info["start"]), abs=0.15)
        assert max(abs(np.array([*info["start"][:2], *info["goal"]]))) <= box + 0.1
        payloads.append(info["variation"]["payload"])
        assert simulation.model.body_subtreemass[1] == pytest.approx(plain + payloads[-1])
        yaws.append(info["start"][2])
        apart.append(math.dist((x, y), env.goal))
    assert [min(payloads), max(payloads)] == pytest.approx([0.0, 4.0], abs=0.3)
    assert [min(yaws), max(yaws)] == pytest.approx([-math.pi, math.pi], abs=0.4)
    assert (min(apart), max(apart)) == pytest.approx((1.0, 2.0), abs=0.1)
    assert 1.0 <= min(apart) <= max(apart) <= 2.0


def test_goals_farther_off_than_anything_are_told(make: Make) -> None:
    env = make("PointNav", goal_distance=(100.0, 200.0))
    with pytest.warns(UserWarning, match="nothing is 100 m away: the farthest goals are taken"):
        env.reset(seed=0)


def test_start_and_goal_can_be_given_as_an_info_reports_them(make: Make) -> None:
    env = make()
    _, info = env.reset(seed=0, options={"start": [1.0, -2.0, 0.5], "goal": [2.0, 2.0]})
    assert (info["start"].tolist(), info["goal"].tolist()) == ([1.0, -2.0, 0.5], [2.0, 2.0])
    simulation = env.driven.simulation
    assert (*simulation.position[:2], simulation.yaw) == pytest.approx((1.0, -2.0, 0.5), abs=0.05)
    _, again = env.reset(options={"start": info["start"], "goal": info["goal"].astype("f4")})
    assert as_json(again) == as_json(info)


def test_starts_on_which_no_rover_can_stand_are_drawn_again_but_not_for_ever(
    make: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    env, tried = make(), list[object]()

    def refuse(scene: Any, _: object) -> None:  # noqa: ANN401
        tried.append(scene.world.start)
        raise (UsageError("it slid"), RunFailed("it fell"))[len(tried) % 2]

    monkeypatch.setattr("harness.gym.course.check_start", refuse)
    with pytest.raises(UsageError, match=r"no start was found on .*, seed 3, in 20 tries"):
        env.reset(seed=3)
    assert len({*tried}) == 20
    tried.clear()
    with pytest.raises(RunFailed, match="it fell"):
        env.reset(options={"start": (0.5, 0.0, 0.0)})
    assert len(tried) == 1  # a start that was asked for is not drawn again


@pytest.mark.parametrize(
    ("limit", "steps"),
    [(0.06, 2), (1.15, 23), (0.3 + 1e-12, 6)],
)
def test_an_episode_has_the_steps_that_its_time_takes(make: Make, limit: float, steps: int) -> None:
    env = make(time_limit=limit)
    for _ in range(2):
        env.reset(options={"start": (0.0, 0.0, 0.0), "goal": (4.0, 0.0)})
        begun_ns = env.driven.simulation.time_ns
        ends = [(*told[2:4], told[4]["ending"]) for told in (env.step(AHEAD) for _ in range(steps))]
        assert ends == [(False, False, "")] * (steps - 1) + [(False, True, "time")]
        assert env.driven.simulation.time_ns - begun_ns == steps * 50_000_000
        assert env.metadata["render_fps"] == 20
        with pytest.raises(ResetNeeded):
            env.step(AHEAD)


def test_difficulty_follows_success_and_a_seed_begins_anew(make: Make) -> None:
    options = {"difficulty": (0.0, 1.0), "curriculum": {"step": 0.5, "window": 1}, "time_limit": 0.05}
    env, here = make(terrain="flat", **options, **NAMED), {"world_seed": 3}

    def difficulties(goal: float, seed: int | None = None) -> list[float]:
        told = [env.reset(seed=seed, options={**here, "goal": (goal, 0.0)})[1]["difficulty"]]
        env.step(AHEAD)  # reached, or the time is over
        return [*told, env.reset(options=here)[1]["difficulty"]]

    before, after = difficulties(0.1, seed=0)
    assert before == 0.0 < after <= 0.5
    assert difficulties(5.0)[1] == 0.0
    difficulties(0.1)
    assert difficulties(0.1, seed=0)[0] == 0.0
    env.step(AHEAD)


def test_episodes_and_worlds_that_are_over_are_gone_at_once(make: Make) -> None:
    # In a circle of references their models, megabytes each, would stay until it is looked for.
    env = make(height_scan=True, depth=[4, 3], episodes_per_world=2)
    env.reset(seed=1)
    env.step(AHEAD)
    gc.collect()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        for _ in range(3):
            env.reset()
            env.step(AHEAD)
        gc.collect()
        found = {type(one).__module__.split(".")[0] for one in gc.garbage}
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
    assert not found & {"harness", "mujoco", "numpy"}


def test_options_of_worlds_from_files_are_those_of_a_run() -> None:
    of_meshes = {"terrain_cell": 0.2, "mesh_unit": "cm", "mesh_up": "y", "rock_height": 0}
    of_meshes |= {"resource_path": "models", "rock": "r*", "hazard": "h*"}
    for file, given, parsed in (
        ("a.sdf", of_meshes, {name: (of_meshes[name],) for name in ("resource_path", "rock", "hazard")}),
        ("a.npy", {"terrain_size": 12, "terrain_height": [2]}, {"terrain_size": (12.0, 12.0)}),
        ("a.npy", {"terrain_size": (12, 10), "terrain_height": 2}, {"terrain_size": (12.0, 10.0)}),
    ):
        options = parse_options(Options, {"terrain": [file, "flat"], **given}, "here")
        known: dict[str, Any] = {**given, **parsed, "terrain": file, "seed": 3}
        known |= {"terrain_height": 2.0} if file == "a.npy" else {}
        assert options.episode(file, 3, 0.9) == Run.of(**known)  # it has no difficulty
        assert options.episode("flat", 3, 0.9) == Run.of(terrain="flat", seed=3, difficulty=0.9)
    of_heightmaps = {"terrain_size", "terrain_height", "terrain_roughness"}
    assert set(FILE_FIELDS) == {*of_meshes, *of_heightmaps}


def test_without_gymnasium_the_mend_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    with pytest.raises(UsageError, match=re.escape("pip install 'rover-harness[gym]'")):
        importlib.reload(harness.gym)


WRONG_OPTIONS = [
    ({"terrain": ["flat", "mars"]}, "available: flat, "),
    ({"terrain": []}, "give at least 1"),
    ({"terrain": "a.sdf", "mesh_unit": "league"}, "mesh unit 'league' does not exist; available: m, "),
    ({"robot": "curiosity"}, "available: "),
    ({"colour": 1}, "key 'colour' does not exist"),
    ({"difficulty": (0.8, 0.2)}, "give two numbers, the lower first"),
    ({"difficulty": [0.5, 1.5]}, "give 0 to 1"),
    ({"difficulty": "hard"}, "give a list"),
    ({"noise": "loud"}, "available: white"),
    ({"randomisation": {"gravity": (1.0, 1.0)}}, "available: friction, mass"),
    *(({"randomisation": {name: (0, 1)}}, "give more than 0") for name in ("friction", "mass")),
    *(({"randomisation": {name: (-1.0, 1.0)}}, "give 0 or more") for name in ("payload", "latency")),
    ({"randomisation": {"latency": (0.0, math.inf)}}, "give a finite number"),
    ({"curriculum": {"step": 2.0}}, "give 0 to 1"),
    ({"curriculum": {"window": 0}}, "give 1 or more"),
    ({"curriculum": {"success": -0.5}}, "give 0 to 1"),
    ({"hazard_budget": math.inf}, "give a finite number"),
    ({"goal_radius": 0.0}, "give more than 0"),
    ({"terrain_cell": [1.0, 2.0]}, "give a number"),
    ({"terrain_size": [11.0, 12.0, 13.0]}, "give at most 2"),
    ({"episodes_per_world": 0}, "give 1 or more"),
    ({"goal_distance": 0}, "give more than 0"),
    ({"time_limit": 0.003}, "time_limit 0.003 s is not valid"),
    *(({"depth": wrong}, "give width and height in pixels") for wrong in ((4,), (4, 4, 4))),
    ({"depth": (0, 4)}, "give "),
    ({"render_mode": "ascii"}, "available: rgb_array, human"),
]


@pytest.mark.parametrize(("options", "message"), WRONG_OPTIONS)
def test_options_that_are_not_valid_are_told_in_a_line(options: dict[str, Any], message: str) -> None:
    made = ENVIRONMENTS["RoverHarness/PointNav-v0"]
    with pytest.raises(UsageError, match=re.escape(message)) as raised:
        made(**options)
    assert "\n" not in str(raised.value)


WRONG_RESETS = [
    ({"wrold_seed": 3}, "did you mean 'world_seed'?"),
    ({"start": (1.0, 2.0)}, "start (1.0, 2.0) is not valid; give at least 3"),
    ({"goal": ("a", "b")}, "give a number"),
    ({"goal": (math.nan, 0.0)}, "give a finite number"),
    ({"goal": (1.0, 2.0, 3.0)}, "give at most 2"),
    ({"start": 5}, "start 5 is not valid; give a list"),
    ({"start": (5.0, 5.0, 0.0)}, "no rover can stand at start 5,5,0: it slid"),
    ({"start": (0.0, SIDE, 0.0)}, "is off the map or at its edge"),
    ({"goal": (0.0, SIDE)}, "is off the map; give x between"),
    ({"terrain": "mars"}, "terrain 'mars' does not exist"),
    ({"difficulty": 1.5, "terrain": "flat"}, "is not valid"),
]
WRONG_ACTIONS = [
    ([math.nan, 0.0], "action [nan, 0.0] is not valid; give finite numbers"),
    ([0.0, math.inf], "give finite numbers"),
    ([[0.5], [0.5]], "an action of shape (2, 1) is not valid; give (2,)"),
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
    assert not np.array_equal(env.step(AHEAD)[0]["imu"], before["imu"])


CODE = re.findall(r"```python\n(.*?)```", (ROOT / "docs/gym.md").read_text(), re.DOTALL)


@pytest.mark.parametrize("code", CODE)
def test_the_code_of_the_page_runs(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(code, {})  # noqa: S102 - our own


def test_without_a_curriculum_the_whole_range_is_drawn_from_whatever_succeeds() -> None:
    ladder, rng = CurriculumSchedule(Curriculum(window=1), (0.2, 0.6)), np.random.default_rng(0)
    ladder.record(success=False)
    draws = [ladder.draw(rng) for _ in range(100)]
    assert 0.2 <= min(draws) < 0.22
    assert 0.58 < max(draws) <= 0.6


@pytest.mark.parametrize(
    ("share", "windows", "highest"),
    [
        (0.75, [3], 0.5),  # three of four are enough
        (0.75, [4, 4], 0.8),
        (0.75, [4, 4, 4], 0.9),  # not beyond the range
        (0.75, [4, 4, 2], 0.8),  # half of the wanted share is 1.5: it stays
        (0.75, [4, 4, 1], 0.5),
        (0.75, [0, 0], 0.2),  # not below it
        (0.5, [4, 2], 0.8),  # all that is wanted is harder
        (0.5, [4, 4, 1], 0.8),  # half of it is not yet easier
        (0.5, [4, 4, 0], 0.5),
    ],
)
def test_a_window_of_episodes_moves_the_upper_end(
    share: float, windows: list[int], highest: float
) -> None:
    ladder = CurriculumSchedule(Curriculum(step=0.3, window=4, success=share), (0.2, 0.9))
    for successes in windows:
        for episode in range(4):
            ladder.record(success=episode < successes)
    assert ladder.highest == pytest.approx(highest)
    assert 0.2 <= ladder.draw(np.random.default_rng(1)) <= highest


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_heights_are_those_of_a_plane_around_the_rover(yaw: float) -> None:
    x, y = np.meshgrid(np.linspace(-5.0, 5.0, 41), np.linspace(-5.0, 5.0, 41))
    plane = Heightfield(0.2 * x - 0.1 * y, 0.25)
    qx, qy, qz, qw = Rotation.from_euler("ZYX", [yaw, 0.2, 0.3]).as_quat().tolist()
    pose = Pose(0, (1.0, -1.0, 0.5), (qx, qy, qz, qw))  # roll and pitch do not turn it
    ahead = observation.AHEAD
    seen = np.array(heights_around(plane, pose)).reshape(len(ahead), len(LEFT))
    here, along, aside = 0.3 - 0.5, 0.2 * math.cos(yaw) - 0.1 * math.sin(yaw), -0.2 * math.sin(yaw)
    aside -= 0.1 * math.cos(yaw)
    assert seen == pytest.approx(here + along * np.array(ahead)[:, None] + aside * np.array(LEFT))
    assert (ahead[0], ahead[-1], LEFT[0], LEFT[-1]) == (-0.5, 1.5, 0.6, -0.6)
    assert "-0.5 to 1.5 m ahead, 0.6 m left to right" in height_part().about


def test_an_observation_is_kept_within_its_space() -> None:
    space: Any = space_of(point_nav_parts(3, 10.0))
    limits = Limits(space)
    for sign in (1.0, -1.0):
        values = {name: np.full(box.shape or (), sign * 1e9) for name, box in space.items()}
        seen = limits.keep(values)
        assert space.contains(seen)
        again = limits.keep(values)
        assert not any(np.shares_memory(seen[name], again[name]) for name in seen)
        ends = {name: getattr(box, "high" if sign > 0 else "low") for name, box in space.items()}
        assert all(seen[name].tolist() == end.tolist() for name, end in ends.items())
    within = {name: np.linspace(-0.5, 0.5, *box.shape).clip(box.low) for name, box in space.items()}
    kept = limits.keep(within)
    assert all(kept[name].tolist() == value.astype("f4").tolist() for name, value in within.items())
