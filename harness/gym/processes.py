"""Many environments in processes that own a part of them each, and write what it saw into shared memory.

The process that asks is one of them, and steps its part while the others step theirs.
Threads share the interpreter's lock, processes do not. What the environments do is the same, to the bit.
The memory has no name: nothing of it is left, whichever way the processes end.
"""

import contextlib
import multiprocessing
from collections.abc import Callable, Sequence
from itertools import pairwise
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from typing import Any

import numpy as np
from gymnasium.error import InvalidAction
from gymnasium.vector import AutoresetMode
from joblib import cpu_count
from numpy.typing import NDArray

from harness.base.errors import RunFailed, UsageError
from harness.base.interrupt import held_back
from harness.gym.env import Info, RoverEnv
from harness.gym.many import Flags, ManyRovers
from harness.gym.observation import Observation
from harness.gym.shared import Shared, answered, serve, stay_awake
from harness.gym.vector import RoverVectorEnv

EXIT_PATIENCE = 0.5  # [s] for a process to leave before it is killed


def vector(
    make: Callable[..., RoverEnv[Any]],
    *,
    processes: int = 1,
    threads: int = 0,
    **options: Any,  # noqa: ANN401 - those of the two classes
) -> "RoverVectorEnv | ProcessVectorEnv":
    """Returns many environments in this process, or in several.

    Args:
        make: Makes one environment.
        processes: Number of processes; 0 for one per processor, 1 for this one.
        threads: As of RoverVectorEnv; 1 in each of several processes if left out.
        options: Of the vector and of each environment.

    Raises:
        UsageError: A value is not valid.
    """
    if processes < 0:
        raise UsageError(f"processes {processes} is not valid; give 1 or more, or 0 for all processors")
    if (processes or cpu_count()) == 1:
        return RoverVectorEnv(make, threads=threads, **options)
    return ProcessVectorEnv(make, processes=processes or cpu_count(), threads=threads or 1, **options)


class ProcessVectorEnv(ManyRovers):
    """Environments of one kind in several processes; otherwise as RoverVectorEnv.

    Args:
        make: Makes one environment from a render mode and options; can be pickled.
        num_envs: Number of environments.
        processes: Number of processes, this one among them.
        autoreset_mode: As of RoverVectorEnv.
        threads: Of each process, as RoverVectorEnv has it.
        render_mode: Render mode of each environment.
        options: Options of each environment.

    Raises:
        UsageError: A value is not valid.
    """

    def __init__(
        self,
        make: Callable[..., RoverEnv[Any]],
        *,
        num_envs: int = 1,
        processes: int,
        autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
        threads: int = 1,
        render_mode: str | None = None,
        **options: object,
    ) -> None:
        settings: dict[str, Any] = {"threads": threads, "render_mode": render_mode, **options}
        try:
            ForkingPickler.dumps((make, settings))
        except Exception as error:  # whatever a user's object raises
            mend = "give functions of a module, or the names of plug-ins or FILE.py:NAME"
            raise UsageError(f"an option cannot be sent to processes ({error}); {mend}") from error
        ends = np.linspace(0, num_envs, max(1, min(processes, num_envs)) + 1).astype(int).tolist()
        self._parts = [slice(*part) for part in pairwise(ends)]
        given = {"autoreset_mode": autoreset_mode, **settings}
        self._own = RoverVectorEnv(make, num_envs=ends[1], **given)
        super().__init__(self._own.envs[0], num_envs, autoreset_mode)
        self._children: list[tuple[Connection, Any]] = []
        self._start_others(make, given)

    def _start_others(self, make: Callable[..., RoverEnv[Any]], given: dict[str, Any]) -> None:
        """Starts the processes of all parts but the first one, which is this one's."""
        context = multiprocessing.get_context("spawn")
        parts, count = self._own.envs[0].observation_space.spaces, self.num_envs
        shapes = {name: part.shape or () for name, part in parts.items()}
        memory = context.RawArray("b", Shared.size(shapes, count))
        self._shared = Shared.of(memory, shapes, count)
        try:
            with held_back():
                for part in self._parts[1:]:
                    here, there = context.Pipe()
                    args = there, make, (memory, shapes, count, part), given
                    child = context.Process(target=serve, args=args, daemon=True)
                    child.start()
                    there.close()
                    self._children.append((here, child))
        except BaseException:
            self.close()
            raise

    def reset_each(
        self, mask: Flags, seeds: Sequence[int | None], options: dict[str, Any]
    ) -> list[Info]:
        """Begins an episode in those of a mask; returns the info of each, empty of others."""
        return self._ask("reset", [(mask[part], seeds[part], options) for part in self._parts])

    def accept(self, actions: NDArray[np.floating[Any]]) -> None:
        """Takes the actions of the next step, or raises as `step`: a mistake changes nothing."""
        if np.shape(actions) != self._shared.actions.shape:
            raise InvalidAction(f"actions of shape {np.shape(actions)} are not valid; give two each")
        self._shared.actions[:] = actions
        is_sure = self._begun and self._mode is not AutoresetMode.DISABLED
        if not (is_sure and np.isfinite(actions).all()):  # else nobody can refuse: one call less
            self._ask("accept", [()] * len(self._parts))

    def step_each(self, rewards: NDArray[np.float64], terminated: Flags, truncated: Flags) -> list[Info]:
        """Steps all by what was accepted, into arrays of zeros; returns the info of each."""
        infos, shared = self._ask("step", [()] * len(self._parts)), self._shared
        rewards[:], terminated[:], truncated[:] = shared.rewards, shared.terminated, shared.truncated
        return infos

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
        if self.closed:
            raise RuntimeError("the environments are closed")
        own, *others = args
        try:
            for (connection, _), given in zip(self._children, others, strict=True):
                with contextlib.suppress(ConnectionError):  # the answer says why
                    connection.send((request, *given))
            rows = self._shared.rows(self._parts[0])
            answers: list[Any] = [answered(self._own, rows, request, own)]
            answers += [_received(*child) for child in self._children]
        except BaseException:  # of a signal too: an answer would come too late
            self.close()
            raise
        for answer in answers:
            if isinstance(answer, Exception):
                raise answer
        return [one for answer in answers for one in answer]

    def _observations(self) -> Observation:
        return {name: array.copy() for name, array in self._shared.observations.items()}


def _received(connection: Connection, child: Any) -> Any:  # noqa: ANN401 - whatever is answered
    try:
        stay_awake(connection)
        return connection.recv()
    except (EOFError, ConnectionError) as error:
        child.join(EXIT_PATIENCE)
        message = f"a process of the environments died (exit code {child.exitcode})"
        raise RunFailed(message) from error
