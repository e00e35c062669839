import re
from typing import Any
from unittest.mock import Mock

import gymnasium
import numpy as np
import pytest
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.vector import AutoresetMode, SyncVectorEnv

from harness.errors import UsageError
from harness.gym.vector import RoverVectorEnv, _mode

ID = "RoverHarness/PointNav-v0"


def vector(small: dict[str, Any], count: int = 2, **options: object) -> Any:  # noqa: ANN401
    return gymnasium.make_vec(ID, num_envs=count, **{**small, **options})


@pytest.mark.parametrize(("mode", "threads"), list(zip(AutoresetMode, (1, 2, 2), strict=True)))
def test_it_does_what_gymnasiums_own_does_with_single_environments(
    small: dict[str, Any], mode: AutoresetMode, threads: int
) -> None:
    options = {**small, "time_limit": 0.15, "noise": "hardware"}
    ours = vector(options, autoreset_mode=mode.value, threads=threads)
    assert (ours._pool is None) == (threads == 1)  # this one suffices
    plain = SyncVectorEnv([lambda: gymnasium.make(ID, **options)] * 2, autoreset_mode=mode)
    assert ours.observation_space == plain.observation_space
    assert ours.metadata["autoreset_mode"] is mode
    assert_alike(ours.reset(seed=np.int64(5)), plain.reset(seed=5))
    for actions in np.random.default_rng(0).uniform(-1.0, 1.0, (4, 2, 2)).astype(np.float32):
        stepped = ours.step(actions)
        assert_alike(stepped, plain.step(actions))
        if mode is AutoresetMode.DISABLED and stepped[3].any():
            mask = stepped[3]
            told = [envs.reset(options={"reset_mask": mask}) for envs in (ours, plain)]
            assert_alike(*told)
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
        return self.conclude()

    def accept(self, action: Any) -> None:  # noqa: ANN401
        self.accepted = float(action[0])

    def command(self) -> None:
        self.commanded = self.accepted

    def drive(self) -> None:
        self.left, self.count = self.left - 1, self.count + 1

    def conclude(self) -> Any:  # noqa: ANN401
        ended, late = self.left == 0, self.count > 2
        seen, info = self.told()
        return seen, self.commanded, ended and not late, ended and late, info

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

    ours = RoverVectorEnv(counting, num_envs=count, autoreset_mode=mode, threads=count)
    plain = SyncVectorEnv([Counting] * count, autoreset_mode=mode)
    assert_alike(ours.reset(seed=1), plain.reset(seed=1))
    for n, actions in enumerate(np.random.default_rng(1).uniform(-1.0, 1.0, (40, count, 2))):
        stepped = ours.step(actions.astype("f4"))
        assert_alike(stepped, plain.step(actions.astype("f4")))
        if mode is AutoresetMode.DISABLED and (mask := stepped[2] | stepped[3]).any():
            assert_alike(*(envs.reset(options={"reset_mask": mask}) for envs in (ours, plain)))
        if n % 5 == 4:  # also where one has just ended
            assert_alike(ours.reset(), plain.reset())
    ours.close()


def test_modes_of_resets_are_called_as_gymnasiums_values_or_names() -> None:
    for mode in AutoresetMode:
        assert [_mode(name) for name in (mode.value, mode.name)] == [mode, mode]


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
    (
        {"autoreset_mode": "never"},
        "autoreset_mode 'never' does not exist; available: NextStep, SameStep",
    ),
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
        envs.step(np.array([[0.0, 0.0], [0.0, np.nan]], np.float32))
    assert [env.steps for env in envs.envs] == [0, 0]  # nor has the other one driven
    single = Mock(wraps=envs.envs[1])
    envs.envs[1] = single
    envs.close()
    envs.close()
    single.close.assert_called_once()
    with pytest.raises(RuntimeError, match="after shutdown"):  # there are no threads any more
        envs.step(actions)
