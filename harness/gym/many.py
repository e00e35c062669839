"""Many environments as Gymnasium's VectorEnv has them, in one process or in several.

Processes own a part of the environments each, and write what it saw into shared memory; the process that
asks is one of them, and steps its part while the others step theirs. Threads share the interpreter's
lock, processes do not. What the environments do is the same, to the bit. The memory has no name: nothing
of it is left, whichever way the processes end.
"""

import contextlib
import multiprocessing
from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from typing import Any

import numpy as np
from gymnasium.error import InvalidAction, ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from joblib import cpu_count
from numpy.typing import NDArray

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import held_back
from harness.gym.env import Action, Info, RoverEnv
from harness.gym.observation import Observation
from harness.gym.shared import Flags, Shared, stay_awake
from harness.gym.vector import Part, answered, serve

EXIT_PATIENCE = 0.5  # [s] for a process to leave before it is killed


class ManyRovers(VectorEnv[Observation, Action, NDArray[Any]]):
    """Environments of one kind, each with worlds of its own.

    Args:
        make: Makes one environment from a render mode and options; can be pickled if there are several
            processes.
        num_envs: Number of environments.
        processes: Number of processes, this one among them; 0 for one per processor.
        autoreset_mode: When an environment that has ended begins anew, as Gymnasium defines it.
        threads: Number of threads that do the physics in each process; 0 for one per processor if there
            is one process, else for one.
        render_mode: Render mode of each environment.
        options: Options of each environment.

    Attributes:
        envs: The environments, if all are in this process.

    Raises:
        UsageError: A value is not valid.
    """

    def __init__(
        self,
        make: Callable[..., RoverEnv[Any]],
        *,
        num_envs: int = 1,
        processes: int = 1,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        threads: int = 0,
        render_mode: str | None = None,
        **options: object,
    ) -> None:
        if processes < 0:
            raise UsageError(
                f"processes {processes} is not valid; give 1 or more, or 0 for all processors"
            )
        if num_envs < 1:
            raise UsageError(f"num_envs {num_envs} is not valid; give 1 or more")
        self._mode, self._begun = _mode(autoreset_mode), False
        count = processes or cpu_count()
        given: dict[str, Any] = {
            "mode": self._mode,
            "threads": threads,
            "render_mode": render_mode,
            **options,
        }
        if count > 1:
            given["threads"] = threads or 1
            _check_sendable(make, given)
        ends = np.linspace(0, num_envs, min(count, num_envs) + 1).astype(int).tolist()
        self._parts = [slice(*part) for part in pairwise(ends)]
        self._own = Part(make, ends[1], **given)
        one = self._own.envs[0]
        if count == 1:
            self.envs = self._own.envs
        self.num_envs, self.render_mode = num_envs, one.render_mode
        self.metadata = {**one.metadata, "autoreset_mode": self._mode}
        self.single_observation_space = one.observation_space
        self.single_action_space = one.action_space
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._children: list[tuple[Connection, Any]] = []
        self._start_others(make, given)

    def _start_others(self, make: Callable[..., RoverEnv[Any]], given: dict[str, Any]) -> None:
        """Starts the processes of all parts but the first one, which is this one's."""
        context, count, others = multiprocessing.get_context("spawn"), self.num_envs, self._parts[1:]
        spaces = self._own.envs[0].observation_space.spaces
        shapes = {name: part.shape or () for name, part in spaces.items()}
        size = Shared.size(shapes, count)
        memory = context.RawArray("b", size) if others else bytearray(size)
        self._shared = Shared.of(memory, shapes, count)
        self._own.rows = self._shared.rows(self._parts[0])
        if not others:
            return
        try:
            with held_back():
                for part in others:
                    here, there = context.Pipe()
                    args = there, make, (memory, shapes, count, part), given
                    child = context.Process(target=serve, args=args, daemon=True)
                    child.start()
                    there.close()
                    self._children.append((here, child))
        except BaseException:
            self.close()
            raise

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, Info]:
        """Begins an episode in each environment, or in those of options["reset_mask"] (num_envs,).

        A seed is that of the first environment, which the following numbers follow, or one for each.
        """
        options = dict(options or {})
        mask = self._checked_mask(options.pop("reset_mask", np.ones(self.num_envs, np.bool_)))
        seeds = self._seeds(seed)
        infos = self._ask("reset", [(mask[part], seeds[part], options) for part in self._parts])
        self._begun = True
        return self._observations(), self._batched(infos)

    def step(self, actions: Action) -> tuple[Observation, NDArray[np.float64], Flags, Flags, Info]:
        """Steps all by actions (num_envs, 2); with NEXT_STEP, one that has ended begins anew instead."""
        if (shape := np.shape(actions)[:1]) != (self.num_envs,):
            count = shape[0] if shape else "no"
            raise UsageError(f"{count} actions are not valid; give {self.num_envs}, one for each")
        shared, nothing = self._shared, [()] * len(self._parts)
        if np.shape(actions) != shared.actions.shape:
            raise InvalidAction(f"actions of shape {np.shape(actions)} are not valid; give two each")
        shared.actions[:] = actions
        is_sure = self._begun and self._mode is not AutoresetMode.DISABLED
        if not (is_sure and np.isfinite(actions).all()):  # else nobody can refuse: one call less
            self._ask("accept", nothing)
        infos = self._batched(self._ask("step", nothing))
        ends = shared.terminated.copy(), shared.truncated.copy()
        return self._observations(), shared.rewards.copy(), *ends, infos

    def render(self) -> tuple[Any, ...]:
        """Returns what each environment draws."""
        return tuple(self._ask("render", [()] * len(self._parts)))

    def close_extras(self, **_: Any) -> None:  # noqa: ANN401 - gymnasium's signature
        """Ends the other processes."""
        for connection, _child in self._children:
            connection.close()
        for _connection, child in self._children:
            child.join(EXIT_PATIENCE)
            if child.is_alive():
                child.kill()
                child.join()
        self._children.clear()
        self._own.close()

    def _ask(self, request: str, args: Sequence[tuple[Any, ...]]) -> list[Any]:
        """Asks all processes at once; returns their answers, one after the other, or raises an error."""
        if self.closed and len(self._parts) > 1:
            raise RuntimeError("the environments are closed")
        own, *others = args
        try:
            for (connection, _), given in zip(self._children, others, strict=True):
                with contextlib.suppress(ConnectionError):  # the answer says why
                    connection.send((request, *given))
            answers: list[Any] = [answered(self._own, request, own)]
            answers += [_received(*child) for child in self._children]
        except BaseException:  # of a signal too: an answer would come too late
            if self._children:
                self.close()
            raise
        for answer in answers:
            if isinstance(answer, Exception):
                raise answer
        return [one for answer in answers for one in answer]

    def _observations(self) -> Observation:
        return {name: array.copy() for name, array in self._shared.observations.items()}

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


def _check_sendable(make: Callable[..., RoverEnv[Any]], given: dict[str, Any]) -> None:
    try:
        ForkingPickler.dumps((make, given))
    except Exception as error:  # whatever a user's object raises
        mend = "give functions of a module, or the names of plug-ins or FILE.py:NAME"
        raise UsageError(f"an option cannot be sent to processes ({error}); {mend}") from error


def _received(connection: Connection, child: Any) -> Any:  # noqa: ANN401 - whatever is answered
    try:
        stay_awake(connection)
        return connection.recv()
    except (EOFError, ConnectionError) as error:
        child.join(EXIT_PATIENCE)
        message = f"a process of the environments died (exit code {child.exitcode})"
        raise RunFailed(message) from error


def _mode(mode: str | AutoresetMode) -> AutoresetMode:
    named = {name: choice for choice in AutoresetMode for name in (choice, choice.name, choice.value)}
    if mode not in named:
        available = ", ".join(choice.value for choice in AutoresetMode)
        raise UsageError(f"autoreset_mode '{mode}' does not exist; available: {available}")
    return named[mode]
