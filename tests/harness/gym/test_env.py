import gc
import importlib
import json
import math
import pickle
import re
import sys
import warnings
from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar
from unittest.mock import Mock, call

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded

import harness.gym
from harness.base.errors import Diverged, RunFailed, UsageError
from harness.base.sim_time import NANOSECONDS
from harness.episode.assembly import world_of
from harness.gym import ENVIRONMENTS
from harness.gym.env import RoverEnv
from harness.gym.options import Curriculum, Options, Randomisation, parse_options
from harness.samples import Twist
from harness.sensors.depth import DepthOptions
from harness.spec.run import Run
from harness.spec.world import FILE_FIELDS
from harness.world.world import terrain_hash
from tests.harness.gym.conftest import SIDE, Make

AHEAD = np.array([1.0, 0.0], np.float32)
NAMES = [name.removeprefix("RoverHarness/").removesuffix("-v0") for name in ENVIRONMENTS]


class Counted(RoverEnv[Options]):
    """Observes how many steps were read of which episode; tells what it is to tell."""

    options_class = Options
    endings: ClassVar[Mapping[str, str]] = {
        "won": "terminated: it has won",
        "lost": "terminated: it has not",
        "edge": "truncated: off",
    }
    camera = DepthOptions(name="depth", width=2, height=1, rate=20)

    def __init__(self, render_mode: str | None = None, **options: object) -> None:
        super().__init__(render_mode, **options)
        self.observation_space = gymnasium.spaces.Dict(count=gymnasium.spaces.Box(-9.0, 9.0, (2,)))
        low, high = np.array([[-1.0, -2.0], [1.0, 3.0]], np.float32)
        self.action_space = gymnasium.spaces.Box(low, high)
        self.begun, self.tell = 0, ""

    @property
    def _camera(self) -> DepthOptions:
        return self.camera

    @property
    def _box(self) -> float:
        return 3.5

    def _begin(self, ride: Any) -> None:  # noqa: ANN401, ARG002
        self.begun += 1

    def _twist(self, action: list[float]) -> Twist:
        return Twist(*action)

    def _observe(self, ride: Any) -> Mapping[str, object]:  # noqa: ANN401
        return {"count": (self.begun, ride.reads)}

    def _judge(self, ride: Any, failure: str) -> Any:  # noqa: ANN401, ARG002
        return 0.5 * self.steps, self.tell or failure, {"is_success": self.tell == "won"}


def as_json(told: object) -> str:
    return json.dumps(told, default=np.ndarray.tolist)


class Bare:
    """An environment whose courses and rides have no physics."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, **options: object) -> None:
        self.rides: list[Any] = []
        self.course = Mock(side_effect=self._course)
        self.ride = Mock(side_effect=self._ride)
        self.places = Mock()
        self.places.draw.side_effect = lambda rng, *_: (rng.uniform(-3.0, 3.0), 1.0)
        monkeypatch.setattr("harness.gym.env.Course", self.course)
        monkeypatch.setattr("harness.gym.env.DrivenRover", self.ride)
        self.env = Counted(**options)  # type: ignore[arg-type]

    def _course(self, config: Run, camera: object) -> Any:  # noqa: ANN401, ARG002
        start = SimpleNamespace(world=SimpleNamespace(start=(7.0, 8.0, 9.0)))
        return SimpleNamespace(run=config, places=self.places, scene=start)

    def _ride(self, course: Any, start: Any, variation: Any, seed: int) -> Any:  # noqa: ANN401
        made = SimpleNamespace(course=course, start=start, variation=variation, seed=seed, reads=0)
        scene = SimpleNamespace(world=SimpleNamespace(start=start))
        settled = (start[0] + 0.125, start[1], 0.2)
        made.simulation = SimpleNamespace(position=settled, scene=scene, data=object())
        made.work = Mock()
        made.work.read.side_effect = lambda: setattr(made, "reads", made.reads + 1)
        made.command, made.drive, made.read = made.work.command, made.work.drive, made.work.read
        self.rides.append(made)
        return made

    def reset(self, seed: int | None = None, **options: object) -> dict[str, Any]:
        return self.env.reset(seed=seed, options=options)[1]


def test_worlds_come_from_the_seed_and_stay_for_their_episodes(monkeypatch: pytest.MonkeyPatch) -> None:
    bare = Bare(monkeypatch, episodes_per_world=2, terrain=["flat", "gravel"], difficulty=(0.2, 0.6))
    infos = [bare.reset(seed) for seed in (5, *[None] * 100)]
    worlds = [(info["terrain"], info["world_seed"], info["difficulty"]) for info in infos]
    assert worlds[:-1:2] == worlds[1::2]
    assert len({*worlds[::2]}) == len(worlds[::2]) == bare.course.call_count == 51
    assert worlds[0][1] == 5
    configs, cameras = zip(*(call.args for call in bare.course.mock_calls), strict=True)
    assert [(made.world.terrain, made.seed, made.world.difficulty) for made in configs] == worlds[::2]
    assert {*cameras} == {Counted.camera}
    share = [terrain for terrain, _, _ in worlds[::2]].count("flat")
    assert 12 < share < 40
    assert len({tuple(worlds[n][0] for n in range(at, at + 20, 2)) for at in range(0, 80, 20)}) > 2
    difficulties = [difficulty for _, _, difficulty in worlds]
    assert [min(difficulties), max(difficulties)] == pytest.approx([0.2, 0.6], abs=0.03)
    noises = [ride.seed for ride in bare.rides]
    assert (noises[0], len({*noises})) == (5, len(noises))  # each episode has noise of its own
    assert 2**30 < max(noises) < 2**31
    assert noises[::2] == [seed for _, seed, _ in worlds[::2]]
    again = Bare(monkeypatch, episodes_per_world=2, terrain=["flat", "gravel"], difficulty=(0.2, 0.6))
    for _ in range(2):  # a seed begins anew, wherever it comes
        for expected, seed in zip(infos[:3], (5, None, None), strict=True):
            assert as_json(again.reset(seed)) == as_json(expected)


def test_a_world_asked_for_by_any_of_its_properties_is_a_new_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bare = Bare(monkeypatch)
    bare.reset(1)
    asked: dict[str, Any] = {"terrain": "slope", "difficulty": 0.0, "world_seed": 0}
    for count, (key, value) in enumerate(asked.items(), 2):
        for _ in range(2):  # the second for another place in it
            info = bare.reset(**{key: value} if bare.course.call_count < count else {"goal": (1.0, 1.0)})
            assert (info[key], bare.course.call_count) == (value, count)
    with pytest.raises(UsageError, match=r"difficulty 1.5 is not valid; give 0 to 1"):
        bare.reset(difficulty=1.5)


def test_starts_and_goals_are_drawn_around_and_variations_are_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bare = Bare(monkeypatch, goal_distance=(1.0, 2.0), randomisation={"payload": (0.0, 4.0)})
    infos = [bare.reset(seed) for seed in (0, *[None] * 99)]
    drawn = bare.places.draw.call_args_list
    for info, ride, start, goal in zip(infos, bare.rides, drawn[::2], drawn[1::2], strict=True):
        assert start.args[1:] == ((0.0, 0.0), (0.0, math.inf), 3.5)
        settled = ride.start[0] + 0.125, ride.start[1]
        assert goal.args[1:] == (settled, (1.0, 2.0), 3.5)
        assert info["start"].tolist() == [*ride.start]
        assert ride.start[1] == info["goal"][1] == 1.0  # y, as it was drawn
        assert info["variation"] == vars(ride.variation)
    payloads = [info["variation"]["payload"] for info in infos]
    yaws = [ride.start[2] for ride in bare.rides]
    assert [min(payloads), max(payloads)] == pytest.approx([0.0, 4.0], abs=0.2)
    assert [min(yaws), max(yaws)] == pytest.approx([-math.pi, math.pi], abs=0.2)
    assert bare.env.goal == tuple(infos[-1]["goal"])
    given: dict[str, Any] = {"start": [1, 2, 3], "goal": [4, 5]}
    bare.places.draw.reset_mock()
    _, info = bare.env.reset(options=given)
    assert given == {"start": [1, 2, 3], "goal": [4, 5]}
    assert (bare.rides[-1].start, bare.env.goal) == ((1.0, 2.0, 3.0), (4.0, 5.0))
    bare.places.draw.assert_not_called()
    still = Bare(monkeypatch, random_start=False)
    assert still.reset(0)["start"].tolist() == [7.0, 8.0, 9.0]  # where harness.run starts


def test_starts_at_which_it_cannot_stand_are_drawn_again_but_not_for_ever(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    bare = Bare(monkeypatch)
    wrong: list[Exception] = [UsageError("it slid"), RunFailed("it fell")]
    bare.ride.side_effect = lambda *args: bare._ride(*args) if not wrong else throw(wrong.pop())
    bare.reset(0)
    assert len({call.args[1] for call in bare.ride.mock_calls}) == 3
    bare.ride.side_effect = UsageError("it slid")
    bare.ride.reset_mock()
    with pytest.raises(UsageError, match="no start was found on rocky, seed 3, in 20 tries; choose"):
        bare.reset(3)
    assert bare.ride.call_count == 20
    with pytest.raises(UsageError, match="it slid"):
        bare.reset(start=(0.0, 0.0, 0.0))
    assert bare.ride.call_count == 21  # one that was asked for is no draw


def throw(error: Exception) -> None:
    raise error


@pytest.mark.parametrize(
    ("limit", "steps"),
    [(0.05, 1), (0.06, 2), (0.1, 2), (1.15, 23), (0.3 + 1e-12, 6), (0.35, 7)],
)
def test_an_episode_has_the_steps_that_its_time_takes(
    monkeypatch: pytest.MonkeyPatch, limit: float, steps: int
) -> None:
    bare = Bare(monkeypatch, time_limit=limit)
    for _ in range(2):
        bare.reset()
        told = [bare.env.step(AHEAD) for _ in range(steps)]
        ends = [(*step[2:4], step[4]["ending"]) for step in told]
        assert ends == [(False, False, "")] * (steps - 1) + [(False, True, "time")]
        assert [step[1] for step in told] == [0.5 * n for n in range(1, steps + 1)]


def test_a_step_is_driven_read_and_judged_and_its_failure_told(monkeypatch: pytest.MonkeyPatch) -> None:
    climbing = {"step": 0.5, "window": 1}
    bare = Bare(monkeypatch, time_limit=0.1, difficulty=(0.0, 1.0), curriculum=climbing)
    env = bare.env
    seen, info = env.reset(seed=0)
    assert (seen["count"].tolist(), info["difficulty"]) == ([1.0, 0.0], 0.0)
    assert env.step(np.array([0.5, -1.5], np.float32))[0]["count"].tolist() == [1.0, 1.0]
    assert bare.rides[-1].work.mock_calls == [call.command(Twist(0.5, -1.5)), call.drive(), call.read()]
    bare.reset()
    env.step(np.array([0.1, 0.2]))
    bare.rides[-1].command.assert_called_with(Twist(0.1, 0.2))  # as exactly as it was given
    bare.reset()
    for action, driven in (([50.0, -7.0], Twist(1.0, -2.0)), ([-3.0, 3.5], Twist(-1.0, 3.0))):
        env.step(np.array(action, np.float32))
        bare.rides[-1].command.assert_called_with(driven)  # what is beyond the space is its end
    for error, ending in ((Diverged("far"), "diverged"), (RunFailed("off"), "edge")):
        bare.reset()
        ride, seen = bare.rides[-1], env.step(AHEAD)[0]
        ride.read.side_effect, ride.reads = error, 5
        told = env.step(AHEAD)
        assert told[0]["count"].tolist() == seen["count"].tolist()  # as it was before
        assert (*told[2:4], told[4]["ending"]) == (False, True, ending)  # the time is over, too
        assert env._schedule.highest == 0.0
        with pytest.raises(ResetNeeded):
            env.step(AHEAD)
    for env.tell, highest in (("lost", 0.0), ("won", 0.5)):
        bare.reset()
        assert (*env.step(AHEAD)[2:4], env._schedule.highest) == (True, False, highest)
    assert 0.0 < bare.reset(world_seed=3)["difficulty"] < 0.5
    bare.reset(0)
    assert env._schedule.highest == 0.0


def test_what_draws_is_closed_and_made_anew_and_a_window_shows_every_step(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    painter = Mock()
    monkeypatch.setattr("harness.gym.env.Painter", painter)
    bare = Bare(monkeypatch, render_mode="human", time_limit=0.1)
    env = bare.env
    for draws in (1, 4):
        bare.reset()
        assert painter.return_value.draw.call_count == draws
        for _ in range(2):
            env.step(AHEAD)
    draws = painter.return_value.draw
    assert draws.call_count == 6
    assert draws.call_args.args == (env.course, bare.rides[-1].simulation.data, env.goal)
    env.close()
    env.close()
    assert (painter.call_count, painter.return_value.close.call_count) == (1, 1)
    env.render()
    assert painter.mock_calls.count(call(window=True)) == 2
    images = Bare(monkeypatch, render_mode="rgb_array")
    images.reset()
    assert images.env.render() is painter.return_value.draw.return_value
    assert painter.call_args == call(window=False)
    assert pickle.loads(pickle.dumps(images.env)).render_mode == "rgb_array"  # noqa: S301


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("checker", ["gymnasium.utils", "stable_baselines3.common"])
def test_gymnasiums_checker_and_stable_baselines3s_have_nothing_to_say(
    make: Make, checker: str, name: str
) -> None:
    reason = "stable-baselines3 is not installed (examples/requirements-train.txt)"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what its own imports say
        check_env = pytest.importorskip(f"{checker}.env_checker", reason=reason).check_env
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        if name == "RoboTerrain":  # whose actions are metres a second and radians, as they are there
            warnings.filterwarnings("ignore", "(?i).*we recommend .* a symmetric and normalized")
        check_env(make(name), skip_render_check=True)


@pytest.mark.parametrize("name", NAMES)
def test_an_environment_survives_pickling_and_its_spec_a_file(small: dict[str, Any], name: str) -> None:
    env = gymnasium.make(f"RoverHarness/{name}-v0", **{**small, "randomisation": {"mass": [0.9, 1.1]}})
    assert env.spec is not None
    again = gymnasium.make(gymnasium.envs.registration.EnvSpec.from_json(env.spec.to_json()))
    seen = [e.reset(seed=4) for e in (env, again, pickle.loads(pickle.dumps(env.unwrapped)))]  # noqa: S301
    assert as_json(seen[0]) == as_json(seen[1]) == as_json(seen[2])
    env.close()
    env.close()


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


def test_what_worlds_from_files_leave_open_is_told_as_on_the_command_line() -> None:
    of_meshes = {"terrain_cell": 0.2, "mesh_unit": "cm", "mesh_up": "y", "rock_height": 0}
    of_meshes |= {"resource_path": "models", "rock": "r*", "hazard": "h*"}
    lists = {"resource_path": ("models",), "rock": ("r*",), "hazard": ("h*",)}
    for file, given, told in (
        ("a.sdf", of_meshes, of_meshes | lists),
        ("a.npy", {"terrain_size": 12, "terrain_height": 2}, {"terrain_size": (12.0, 12.0)}),
        ("a.npy", {"terrain_size": (12, 10), "terrain_height": [2]}, {"terrain_size": (12.0, 10.0)}),
    ):
        options = parse_options(Options, {"terrain": [file, "flat"], **given}, "here")
        known: dict[str, Any] = {**given, **told, "terrain": file, "seed": 3}
        known |= {"terrain_height": 2.0} if file == "a.npy" else {}
        assert options.episode(file, 3, 0.9) == Run.of(**known)  # it has no difficulty
        assert options.episode("flat", 3, 0.9) == Run.of(terrain="flat", seed=3, difficulty=0.9)
    assert set(FILE_FIELDS) == {*of_meshes, "terrain_size", "terrain_height"}
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
    expected = world_of(Run.of(terrain="gravel", seed=5, difficulty=0.25))
    assert terrain_hash(env.course.scene.world) == terrain_hash(expected)


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
    assert np.hypot(*(env.driven.simulation.position[:2] - np.array([1.0, -2.0]))) < 0.05
    assert env.driven.simulation.yaw == pytest.approx(0.5, abs=0.05)
    before_ns = env.driven.simulation.time_ns
    env.step(AHEAD)
    assert (env.driven.simulation.time_ns - before_ns) * env.metadata["render_fps"] == NANOSECONDS
    _, info = env.reset(options={"goal": (1.0, 1.0)})
    assert info["world_seed"] == 0  # no other world for another goal


POSITIVE = ("friction", "mass", "motor_strength")  # factors
WRONG_OPTIONS = [
    ({"terrain": "mars"}, "available: flat, "),
    ({"terrain": ["flat", "mars"]}, "available: flat, "),
    ({"terrain": []}, "give at least 1"),
    ({"robot": "curiosity"}, "available: leo"),
    ({"colour": 1}, "key 'colour' does not exist"),
    (
        {"difficulty": (0.8, 0.2)},
        "give two numbers, the lower first",
    ),
    ({"difficulty": 1.5}, "give 0 to 1"),
    ({"difficulty": [0.5, 1.5]}, "give 0 to 1"),
    ({"difficulty": "hard"}, "give a list"),
    ({"noise": "loud"}, "available: white"),
    ({"randomisation": Randomisation}, "is not valid"),
    ({"randomisation": {"gravity": (1.0, 1.0)}}, "available: friction, mass"),
    *(({"randomisation": {name: (0.0, 1.0)}}, "give more than 0") for name in POSITIVE),
    *(({"randomisation": {name: (-1.0, 1.0)}}, "give 0 or more") for name in ("payload", "latency")),
    ({"randomisation": {"latency": (0.0, math.inf)}}, "give a finite number"),
    ({"curriculum": {"step": 2.0}}, "give 0 to 1"),
    ({"curriculum": {"window": 0}}, "give 1 or more"),
    ({"curriculum": {"success": -0.5}}, "give 0 to 1"),
    ({"hazard_budget": math.inf}, "give a finite number"),
    ({"goal_radius": 0.0}, "give more than 0"),
    *(
        ({name: [1.0, 2.0]}, "give a number")
        for name in ("terrain_height", "terrain_cell", "rock_height")
    ),
    ({"terrain_size": [11.0, 12.0, 13.0]}, "give at most 2"),
    ({"episodes_per_world": 0}, "give 1 or more"),
    ({"goal_distance": 0}, "give more than 0"),
    ({"time_limit": 0.003}, "duration 0.003 s is not valid"),
    ({"depth": (4,)}, "give width and height in pixels"),
    ({"depth": (4, 4, 4)}, "give width and height in pixels"),
    ({"depth": (0, 4)}, "give "),
    ({"render_mode": "ascii"}, "available: rgb_array, human"),
]


def test_limits_themselves_are_valid_and_given_as_json_has_them() -> None:
    given = {
        "difficulty": 1,
        "goal_distance": [2, 2],
        "randomisation": {"payload": [0, 0], "latency": [0.0, 0.0], "mass": [1e-3, 1e-3]},
        "curriculum": Curriculum(step=1.0, window=1, success=0.0),
    }
    of_runs: dict[str, Any] = {"noise": "hardware", "robot": "rover_zero4wd", "lidar_beams": 64}
    options = parse_options(Options, given | of_runs, "here")
    assert (options.difficulty, options.goal_distance) == ((1.0, 1.0), (2.0, 2.0))
    other = parse_options(Options, {"goal_distance": 2, "curriculum": {"success": 1.0}}, "here")
    assert (other.goal_distance, other.curriculum.success) == ((2.0, 2.0), 1.0)
    assert options.randomisation == Randomisation(payload=(0.0, 0.0), mass=(1e-3, 1e-3))
    assert options.curriculum == given["curriculum"]
    assert options.episode("flat", 3, 0.9) == Run.of(terrain="flat", seed=3, difficulty=0.9, **of_runs)


@pytest.mark.parametrize(("options", "message"), WRONG_OPTIONS)
def test_options_that_are_not_valid_are_told_in_a_line(options: dict[str, Any], message: str) -> None:
    made = ENVIRONMENTS["RoverHarness/PointNav-v0"]
    with pytest.raises(UsageError, match=re.escape(message)) as raised:
        made(**options)
    assert "\n" not in str(raised.value)


WRONG_RESETS = [
    ({"wrold_seed": 3}, "reset: key 'wrold_seed' does not exist; did you mean 'world_seed'?"),
    ({"start": (1.0, 2.0)}, "reset: start (1.0, 2.0) is not valid; give 3 finite numbers"),
    ({"goal": ("a", "b")}, "reset: goal ('a', 'b') is not valid; give 2 finite numbers"),
    ({"goal": (math.nan, 0.0)}, "give 2 finite numbers"),
    ({"goal": (1.0, 2.0, 3.0)}, "reset: goal (1.0, 2.0, 3.0) is not valid; give 2 finite numbers"),
    ({"start": 5}, "reset: start 5 is not valid; give 3 finite numbers"),
    ({"start": (5.0, 5.0, 0.0)}, "no rover can stand at start 5,5,0: it slid"),
    ({"start": (0.0, SIDE, 0.0)}, "is off the map or at its edge"),
    ({"terrain": "mars"}, "terrain 'mars' does not exist"),
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
    first = env.step(AHEAD)
    assert first[2:4] == (False, False)
    assert not np.array_equal(first[0]["imu"], before["imu"])
    assert env.step(AHEAD)[2:4] == (False, True)  # 0.1 s are over
    with pytest.raises(ResetNeeded):
        env.step(AHEAD)
