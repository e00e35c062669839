import re
from typing import Any
from unittest.mock import Mock, call

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from harness.base.errors import UsageError
from harness.gym import ENVIRONMENTS
from harness.gym.vector import RoverVectorEnv

ID = "RoverHarness/PointNav-v0"


def vector(small: dict[str, Any], count: int = 2, **options: object) -> Any:  # noqa: ANN401
    return gymnasium.make_vec(ID, num_envs=count, **{**small, **options})


def test_it_does_what_gymnasiums_own_does_with_single_environments(small: dict[str, Any]) -> None:
    options, mode = {**small, "time_limit": 0.15, "noise": "hardware"}, AutoresetMode.SAME_STEP
    ours = vector(options, autoreset_mode=mode, threads=2)
    plain = SyncVectorEnv([lambda: gymnasium.make(ID, **options)] * 2, autoreset_mode=mode)
    assert ours.observation_space == plain.observation_space
    assert ours.action_space == plain.action_space
    assert_alike(ours.reset(seed=np.int64(5)), plain.reset(seed=5))
    for actions in np.random.default_rng(0).uniform(-1.0, 1.0, (4, 2, 2)).astype(np.float32):
        assert_alike(ours.step(actions), plain.step(actions))
    ours.close()
    plain.close()


class Counting(gymnasium.Env[dict[str, Any], Any]):
    """Ends after as many steps as it has drawn; tells what not all of them tell at a time."""

    observation_space = gymnasium.spaces.Dict({"step": gymnasium.spaces.Box(0, 9, (1,), np.float32)})
    action_space = gymnasium.spaces.Box(-1.0, 1.0, (2,), np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:  # noqa: ANN401
        super().reset(seed=seed, options=options)
        self.left, self.count = int(self.np_random.integers(1, 5)), 0
        return self.told()

    def step(self, action: Any) -> Any:  # noqa: ANN401
        self.accept(action)
        self.command()
        self.drive()
        self.sense()
        return self.conclude()

    def accept(self, action: Any) -> None:  # noqa: ANN401
        self.accepted = float(action[0])

    def command(self) -> None:
        self.commanded = self.accepted

    def drive(self) -> None:
        self.left, self.count = self.left - 1, self.count + 1

    def sense(self) -> None:
        self.sensed = self.commanded

    def conclude(self) -> Any:  # noqa: ANN401
        ended, late = self.left == 0, self.count > 2
        seen, info = self.told()
        return seen, self.sensed, ended and not late, ended and late, info

    def told(self) -> tuple[dict[str, Any], dict[str, Any]]:
        info: dict[str, Any] = {"left": 0.5 * self.left} if self.count else {"drawn": self.left}
        if self.left % 2:
            info["odd"] = np.full(2, self.left)
        return {"step": np.array([self.count], np.float32)}, info


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("count", [1, 3])
def test_ends_resets_and_infos_that_differ_are_as_in_gymnasiums_own(
    mode: AutoresetMode, count: int
) -> None:
    def counting(**_: object) -> Any:  # noqa: ANN401
        return Counting()

    called = mode.name if count == 1 else mode.value
    ours = RoverVectorEnv(counting, num_envs=count, autoreset_mode=called, threads=count)
    assert ours.metadata["autoreset_mode"] is mode
    plain = SyncVectorEnv([Counting] * count, autoreset_mode=mode)
    assert_alike(ours.reset(seed=1), plain.reset(seed=1))
    for n, actions in enumerate(np.random.default_rng(1).uniform(-1.0, 1.0, (40, count, 2))):
        stepped = ours.step(actions.astype("f4"))
        assert_alike(stepped, plain.step(actions.astype("f4")))
        if mode is AutoresetMode.DISABLED and (mask := stepped[2] | stepped[3]).any():
            assert_alike(*(envs.reset(options={"reset_mask": mask}) for envs in (ours, plain)))
        if n % 7 == 3:
            mask = np.arange(count) % 2 == 0
            assert_alike(*(envs.reset(options={"reset_mask": mask.copy()}) for envs in (ours, plain)))
        if n % 5 == 4:  # also where one has just ended
            assert_alike(ours.reset(), plain.reset())
    ours.close()


@pytest.mark.parametrize(("count", "threads", "used"), [(3, 0, 3), (8, None, 5), (8, 2, 2), (1, 4, 1)])
def test_no_more_threads_work_than_there_is_work_and_this_one_is_one_of_them(
    monkeypatch: pytest.MonkeyPatch, count: int, threads: int | None, used: int
) -> None:
    monkeypatch.setattr("harness.gym.vector.cpu_count", lambda: 5)
    monkeypatch.setattr("harness.gym.vector.ThreadPoolExecutor", pool := Mock())
    told = {} if threads is None else {"threads": threads}
    envs = RoverVectorEnv(lambda **_: Counting(), num_envs=count, **told)  # type: ignore[arg-type]
    submit = pool.return_value.submit
    for some in (count, 1):
        done: list[int] = []
        submit.reset_mock()
        envs._each(done.append, range(some))
        assert (done, submit.call_count) == ([*range(some)], min(used, some) - 1)
    assert [made.args for made in pool.call_args_list] == ([(used - 1,)] if used > 1 else [])
    if used > 1:
        submit.return_value.result.side_effect = UsageError("no place")  # in another thread
        with pytest.raises(UsageError, match="no place"):
            envs._each(done.append, range(count))


def test_each_environment_is_made_drawn_and_masked_by_itself() -> None:
    made = [Mock(wraps=Counting(), metadata={"render_fps": 20}) for _ in range(2)]
    for index, env in enumerate(made):
        env.observation_space, env.action_space = Counting.observation_space, Counting.action_space
        env.render.side_effect = [f"image {index}"]
    make = Mock(side_effect=made)
    envs = RoverVectorEnv(make, num_envs=2, threads=1, render_mode="rgb_array", colour="red")
    assert make.call_args_list == [call(render_mode="rgb_array", colour="red")] * 2
    assert (envs.render(), envs.render_mode) == (("image 0", "image 1"), "rgb_array")
    assert envs.metadata == {"render_fps": 20, "autoreset_mode": AutoresetMode.NEXT_STEP}
    assert made[0].metadata == {"render_fps": 20}
    alone = RoverVectorEnv(lambda **_: Counting())  # type: ignore[arg-type]
    assert (alone.num_envs, alone.metadata["autoreset_mode"]) == (1, AutoresetMode.NEXT_STEP)
    envs.reset(seed=[3, None], options={"goal": 1})
    assert [env.reset.call_args for env in made] == [
        call(seed=s, options={"goal": 1}) for s in (3, None)
    ]
    options = {"reset_mask": np.array([False, True]), "goal": 2}
    envs.reset(seed=7, options=options)
    assert options.keys() == {"reset_mask", "goal"}
    assert [env.reset.call_count for env in made] == [1, 2]
    assert made[1].reset.call_args == call(seed=8, options={"goal": 2})
    envs._mode, envs._ended = AutoresetMode.DISABLED, np.ones(2, np.bool_)
    envs.step(np.zeros((2, 2), np.float32))
    assert [env.reset.call_count for env in made] == [1, 2]  # nobody is begun anew unasked


@pytest.mark.parametrize(("name", "kind"), ENVIRONMENTS.items())
def test_every_environment_is_registered_with_its_vector(name: str, kind: type) -> None:
    envs: Any = gymnasium.make_vec(name, num_envs=2, vectorization_mode="vector_entry_point")
    assert isinstance(envs, RoverVectorEnv)
    assert [type(env) for env in envs.envs] == [kind, kind]
    assert type(gymnasium.make(name).unwrapped) is kind
    envs.close()


def test_a_first_reset_that_failed_halfway_is_not_taken_up_by_a_mask() -> None:
    made = [Counting(), Counting()]
    last = Mock(wraps=made[1])
    last.reset.side_effect = UsageError("no place")
    made[1] = last
    left = iter(made)
    envs = RoverVectorEnv(lambda **_: next(left), num_envs=2, threads=1)  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="no place"):
        envs.reset()
    with pytest.raises(ResetNeeded, match="the first reset"):
        envs.reset(options={"reset_mask": np.array([True, False])})


def assert_alike(one: Any, other: Any) -> None:  # noqa: ANN401 - what steps and resets return
    """To the bit, key by key."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        keys = list(one)
        one, other = ([told[key] for key in keys] for told in (one, other))
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype
    if isinstance(one, list | tuple) or one.dtype == object:
        for mine, its in zip(one, other, strict=True):
            if isinstance(mine, dict | list | tuple | np.ndarray):
                assert_alike(mine, its)
            else:
                assert mine == its
    else:
        np.testing.assert_array_equal(one, other)


WRONG = [
    ({"num_envs": 0}, "num_envs 0 is not valid; give 1 or more"),
    ({"threads": -1}, "threads -1 is not valid; give 1 or more, or 0 for all processors"),
    ({"autoreset_mode": "never"}, "'never' does not exist; available: NextStep, SameStep, Disabled"),
    ({"robot": "spirit"}, "robot 'spirit' does not exist"),
]


@pytest.mark.parametrize(("options", "message"), WRONG)
def test_mistakes_with_a_vector_are_told_in_a_line(options: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=re.escape(message)):
        gymnasium.make_vec(ID, **options)


def test_mistakes_with_many_episodes_are_told_in_a_line(small: dict[str, Any]) -> None:
    envs = vector(small, 2, threads=2)
    actions, mask = np.zeros((2, 2), np.float32), np.array([True, False])
    with pytest.raises(ResetNeeded, match="the first reset"):
        envs.reset(options={"reset_mask": mask})
    with pytest.raises(ResetNeeded, match="no episode to step"):
        envs.step(actions)
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
    single = Mock(wraps=envs.envs[1])
    envs.envs[1] = single
    envs.close()
    envs.close()
    single.close.assert_called_once()
    with pytest.raises(RuntimeError, match="after shutdown"):  # there are no threads any more
        envs.step(actions)
