"""Many environments as Gymnasium's VectorEnv has them, in whichever process they are."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import reduce
from typing import Any

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.gym.env import Action, Info, RoverEnv
from harness.gym.observation import Observation

Flags = NDArray[np.bool_]


class ManyRovers(VectorEnv[Observation, Action, NDArray[Any]], ABC):
    """Environments of one kind, each with worlds of its own: what does not depend on where they are.

    Args:
        one: One of them.
        num_envs: Number of environments.
        autoreset_mode: When an environment that has ended begins anew, as Gymnasium defines it.

    Raises:
        UsageError: A value is not valid.
    """

    def __init__(self, one: RoverEnv[Any], num_envs: int, autoreset_mode: str | AutoresetMode) -> None:
        if num_envs < 1:
            raise UsageError(f"num_envs {num_envs} is not valid; give 1 or more")
        self._mode, self._begun = _mode(autoreset_mode), False
        self.num_envs, self.render_mode = num_envs, one.render_mode
        self.metadata = {**one.metadata, "autoreset_mode": self._mode}
        self.single_observation_space = one.observation_space
        self.single_action_space = one.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Begins an episode in each environment, or in those of options["reset_mask"] (num_envs,).

        A seed is that of the first environment, which the following numbers follow, or one for each.
        """
        options = dict(options or {})
        mask = self._checked_mask(options.pop("reset_mask", np.ones(self.num_envs, np.bool_)))
        infos = self.reset_each(mask, self._seeds(seed), options)
        self._begun = True
        return self._observations(), self._batched(infos)

    def step(self, actions: Action) -> tuple[Observation, NDArray[np.float64], Flags, Flags, Info]:
        """Steps all by actions (num_envs, 2); with NEXT_STEP, one that has ended begins anew instead."""
        if (shape := np.shape(actions)[:1]) != (self.num_envs,):
            count = shape[0] if shape else "no"
            raise UsageError(f"{count} actions are not valid; give {self.num_envs}, one for each")
        rewards = np.zeros(self.num_envs)
        terminated, truncated = np.zeros((2, self.num_envs), np.bool_)
        self.accept(actions)
        infos = self.step_each(rewards, terminated, truncated)
        return self._observations(), rewards, terminated, truncated, self._batched(infos)

    @abstractmethod
    def accept(self, actions: NDArray[np.floating[Any]]) -> None:
        """Takes the actions of the next step, or raises as `step`: a mistake changes nothing."""

    @abstractmethod
    def step_each(
        self, rewards: NDArray[np.float64], terminated: Flags, truncated: Flags
    ) -> Sequence[Info]:
        """Steps all by what was accepted; returns the info of each.

        Args:
            rewards: Zeros, shape (num_envs,); are filled.
            terminated: False, shape (num_envs,); are filled.
            truncated: False, shape (num_envs,); are filled.
        """

    @abstractmethod
    def reset_each(
        self, mask: Flags, seeds: Sequence[int | None], options: dict[str, Any]
    ) -> Sequence[Info]:
        """Begins an episode in some environments; returns the info of each, empty of others.

        Args:
            mask: In which, shape (num_envs,).
            seeds: One per environment; None goes on with its random numbers.
            options: Of Gymnasium's reset, the same for all.
        """

    @abstractmethod
    def _observations(self) -> Observation:
        """What all observed last, in new arrays."""

    def _batched(self, infos: Sequence[Info]) -> Info:
        """The infos of all environments as Gymnasium has them: an array for a key, and who has it."""
        first = infos[0]
        if "final_obs" in first or any(info.keys() != first.keys() for info in infos):
            return reduce(lambda all_, one: self._add_info(all_, one[1], one[0]), enumerate(infos), {})
        batched: Info = {}  # the same in a tenth of the time
        everybody = np.ones((len(first), len(infos)), np.bool_)
        for (key, value), known in zip(first.items(), everybody, strict=True):
            values = [info[key] for info in infos]
            if isinstance(value, dict):
                batched[key] = self._batched(values)
            elif type(value) in {int, float, bool}:
                batched[key] = np.array(values, type(value))
            elif isinstance(value, np.ndarray | np.number):
                batched[key] = np.array(values, value.dtype)
            else:
                batched[key] = np.fromiter(values, object, len(values))
            batched[f"_{key}"] = known
        return batched

    def _seeds(self, seed: int | Sequence[int | None] | None) -> Sequence[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + index for index in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise UsageError(f"{len(seed)} seeds are not valid; give {self.num_envs}, or the first one")
        return seed

    def _checked_mask(self, mask: Flags) -> Flags:
        mask = np.asarray(mask)
        if mask.shape != (self.num_envs,) or mask.dtype != np.bool_ or not mask.any():
            raise UsageError(
                f"reset_mask is not valid; give {self.num_envs} booleans, at least one of them true"
            )
        if not mask.all() and not self._begun:
            raise ResetNeeded("the first reset() begins all environments; leave out reset_mask")
        return mask


def _mode(mode: str | AutoresetMode) -> AutoresetMode:
    named = {name: choice for choice in AutoresetMode for name in (choice, choice.name, choice.value)}
    if mode not in named:
        available = ", ".join(choice.value for choice in AutoresetMode)
        raise UsageError(f"autoreset_mode '{mode}' does not exist; available: {available}")
    return named[mode]
