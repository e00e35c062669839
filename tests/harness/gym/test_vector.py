import re
import threading
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.gym.many import ManyRovers

ID = "RoverHarness/PointNav-v0"
# About every third goal is reached at once, others not at all.
SHORT = {"time_limit": 0.2, "goal_radius": 2.0, "noise": "hardware"}
PLANE = "<geometry><plane><normal>0 0 1</normal><size>14 14</size></plane></geometry>"
LINK = f"<link name='l'><collision name='c'>{PLANE}</collision></link>"
POINT = "<waypoint><time>{0}</time><pose>{0} 1 0 0 0 0</pose></waypoint>"
WALK = f"<trajectory id='0' type='walk'>{POINT.format(0)}{POINT.format(4)}</trajectory>"
YARD = (
    f"<sdf version='1.9'><world name='w'><model name='g'><static>1</static>{LINK}</model>"
    f"<actor name='guy'><script>{WALK}</script></actor></world></sdf>"
)
RUTS = {"soil": ("dry_sand", ""), "keep_ruts": True, "episodes_per_world": 2, "random_start": False}
OTHERS: dict[AutoresetMode, dict[str, Any]] = {
    AutoresetMode.SAME_STEP: RUTS
    | {"randomisation": {"latency": (0.0, 0.1), "soil_friction": (0.5, 1.0)}}
    | {"height_scan": True, "depth": (4, 3), "images": True},
    AutoresetMode.DISABLED: {
        "terrain": "yard.sdf",
        "terrain_size": None,
        "robot": "husky",
        "actuators": "real",
    },
}


def vector(small: dict[str, Any], count: int = 2, **options: object) -> Any:  # noqa: ANN401
    return gymnasium.make_vec(ID, num_envs=count, **{**small, **options})


TWO, EACH = {"threads": 2}, {"processes": 2}


@pytest.mark.parametrize(
    ("mode", "count", "workers"),
    [
        (AutoresetMode.NEXT_STEP, 3, [{"threads": 8}, EACH]),
        (AutoresetMode.SAME_STEP, 3, [TWO, EACH]),
        (AutoresetMode.DISABLED, 3, [TWO, EACH]),
        (AutoresetMode.SAME_STEP, 1, [{"threads": 0}]),
    ],
)
def test_many_do_to_the_bit_what_gymnasiums_own_vector_does_with_single_ones(
    small: dict[str, Any],
    mode: AutoresetMode,
    count: int,
    workers: list[dict[str, int]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("yard.sdf").write_text(YARD)
    options = {**small, **SHORT, "randomisation": {"payload": (0.0, 4.0)}, **OTHERS.get(mode, {})}
    names = {"threads": mode.name, "processes": mode.value}
    ours = [vector(options, count, autoreset_mode=names[min(one)], **one) for one in workers]
    plain = SyncVectorEnv([lambda: gymnasium.make(ID, **options)] * count, autoreset_mode=mode)
    for envs in ours:
        assert envs.observation_space == plain.observation_space
        assert envs.action_space == plain.action_space
        assert envs.metadata == {**plain.metadata, "autoreset_mode": mode}
    every, endings = [plain, *ours], set()
    assert_all_alike([envs.reset(seed=np.int64(5) if envs in ours else 5) for envs in every])
    rng = np.random.default_rng(list(AutoresetMode).index(mode))
    wanted: tuple[dict[str, Any], ...] = (
        {},
        {"goal": (1.0, 2.0)},
        {"start": (0.5, 0.0, 1.0)},
        {"world_seed": 3},
        {"soil": "dry_sand"},
    )
    periods = 16 if mode is AutoresetMode.DISABLED else 11  # each until episodes end in each way
    for n, actions in enumerate(rng.uniform(-1.0, 1.0, (periods, count, 2))):
        stepped, *_ = steps = [envs.step(actions.astype("f4")) for envs in every]
        assert_all_alike(steps)
        endings |= set(zip(stepped[2].tolist(), stepped[3].tolist(), strict=True))
        if mode is AutoresetMode.DISABLED and (mask := stepped[2] | stepped[3]).any():
            for envs in ours:  # nor have those gone on whose episodes have not ended
                with pytest.raises(ResetNeeded):
                    envs.step(actions.astype("f4"))
            assert_all_alike([envs.reset(options={"reset_mask": mask.copy()}) for envs in every])
        if n % 4 == 3:
            mask = rng.permutation(np.arange(count) % 2 == 0)
            seeds = [n if rng.integers(2) else None for _ in range(count)]
            options = wanted[rng.integers(len(wanted))]
            begun = [
                envs.reset(seed=seeds, options={"reset_mask": mask.copy(), **options}) for envs in every
            ]
            assert_all_alike(begun)
        if n % 5 == 4:  # also where one has just ended
            assert_all_alike([envs.reset(seed=n if n > periods - 7 else None) for envs in every])
    assert len(endings) == 3 or count == 1
    for envs in every:
        envs.close()


def test_an_episode_that_ends_and_begins_in_one_step_counts_once_for_the_curriculum() -> None:
    harder = {"difficulty": (0.0, 1.0), "curriculum": {"step": 0.5, "window": 2}}
    options: dict[str, Any] = {"terrain": "flat", "lidar_beams": 8, "episodes_per_world": 1, **harder}
    envs = vector(options, 1, autoreset_mode="SameStep", goal_radius=20.0)  # each step succeeds
    envs.reset(seed=0)
    drawn = [envs.step(np.zeros((1, 2), np.float32))[4]["difficulty"][0] for _ in range(2)]
    envs.close()
    assert drawn[0] == 0.0 < drawn[1]


@pytest.mark.parametrize(("name", "kind"), ENVIRONMENTS.items())
def test_every_environment_is_registered_with_its_vector(name: str, kind: type) -> None:
    envs: Any = gymnasium.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point")
    assert isinstance(envs, ManyRovers)
    assert [type(env) for env in envs.envs] == [kind, kind]
    assert type(gymnasium.make(name).unwrapped) is kind
    envs.close()


def assert_all_alike(expected_and_ours: list[Any]) -> None:
    expected, *ours = expected_and_ours
    for one in ours:
        assert_alike(one, expected)


def assert_alike(one: Any, other: Any) -> None:  # noqa: ANN401 - what steps and resets return
    """To the bit, key by key."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        one, other = list(one.values()), [other[key] for key in one]
    if isinstance(one, list | tuple) or (isinstance(one, np.ndarray) and one.dtype == object):
        for mine, its in zip(one, other, strict=True):
            assert_alike(mine, its)
    elif isinstance(one, np.ndarray):
        assert (one.dtype, one.shape, one.tobytes()) == (other.dtype, other.shape, other.tobytes())
    else:
        assert one == other


WRONG = [
    ({"num_envs": 0}, "num_envs 0 is not valid; give 1 or more"),
    ({"threads": -1}, "threads -1 is not valid; give 1 or more, or 0 for all processors"),
    ({"processes": -1}, "processes -1 is not valid; give 1 or more, or 0 for all processors"),
    ({"processes": 2, "num_envs": 0}, "num_envs 0 is not valid; give 1 or more"),
    ({"processes": 2, "robot": "spirit"}, "robot 'spirit' does not exist"),
    ({"autoreset_mode": "never"}, "'never' does not exist; available: NextStep, SameStep, Disabled"),
    ({"robot": "spirit"}, "robot 'spirit' does not exist"),
]


@pytest.mark.parametrize(("options", "message"), WRONG)
def test_mistakes_with_a_vector_are_told_in_a_line(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        gymnasium.make_vec(ID, **options)


def test_mistakes_with_many_episodes_are_told_in_a_line(small: dict[str, Any]) -> None:
    threads, envs = threading.active_count(), vector(small, 2, threads=2)
    actions, mask = np.zeros((2, 2), np.float32), np.array([True, False])
    with pytest.raises(ResetNeeded, match="the first reset"):
        envs.reset(options={"reset_mask": mask})
    with pytest.raises(ResetNeeded, match="no episode to step"):
        envs.step(actions)
    with pytest.raises(UsageError, match="off the map"):
        envs.reset(options={"start": (50.0, 0.0, 0.0)})
    with pytest.raises(UsageError, match="3 seeds are not valid; give 2, or the first one"):
        envs.reset(seed=[1, 2, 3])
    envs.reset(seed=[1, 2])
    for wrong in (~mask & mask, np.array([1, 0]), np.array([True])):
        with pytest.raises(UsageError, match="reset_mask is not valid; give 2 booleans"):
            envs.reset(options={"reset_mask": wrong})
    with pytest.raises(UsageError, match="1 actions are not valid; give 2, one for each"):
        envs.step(actions[:1])
    with pytest.raises(UsageError, match="no actions are not valid"):
        envs.step(np.float32(0.5))
    with pytest.raises(InvalidAction, match="finite numbers"):
        envs.step(np.array([[0.5, 0.5], [0.0, np.nan]], np.float32))
    assert [env.steps for env in envs.envs] == [0, 0]  # nor has the other one driven
    told = envs.step(actions)[4]["reward_terms"]
    assert told["action_rate"].tolist() == [0.0, 0.0]  # or been commanded
    assert threading.active_count() > threads
    envs.close()
    envs.close()
    assert threading.active_count() == threads
    envs.step(actions)  # alone
    assert [env.steps for env in envs.envs] == [2, 2]
