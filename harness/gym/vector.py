"""Environments that one process steps together, on all processors.

Each is an environment of its own, with its own world, and each trajectory is the one that it drives by
itself, to the bit. The physics of some is done by other threads, which do without the interpreter, while
this thread reads what has been driven.
"""

import contextlib
import signal
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from joblib import cpu_count

from harness.base.errors import UsageError
from harness.gym.env import Info, RoverEnv
from harness.gym.observation import Observation
from harness.gym.shared import AWAKE, Flags, Shapes, Shared, stay_awake
from harness.physics.physics import Physics
from harness.physics.pool import Pool


class Part:
    """Those of many environments that are in one process.

    Args:
        make: Makes one environment from a render mode and options.
        num_envs: Number of environments.
        mode: When an environment that has ended begins anew.
        threads: Number of threads that do the physics, this one among them; 0 for one per processor.
        options: Render mode and options of each environment.

    Attributes:
        envs: The environments.
        rows: Theirs of the memory that all processes share; to be set before anything is asked.

    Raises:
        UsageError: A value is not valid.
    """

    rows: Shared

    def __init__(
        self,
        make: Callable[..., RoverEnv[Any]],
        num_envs: int,
        *,
        mode: AutoresetMode,
        threads: int,
        **options: object,
    ) -> None:
        if threads < 0:
            raise UsageError(f"threads {threads} is not valid; give 1 or more, or 0 for all processors")
        self._mode, self.num_envs = mode, num_envs
        self.envs = [make(**options) for _ in range(num_envs)]
        others = min(num_envs, threads or cpu_count()) - 1
        self._pool = Pool(num_envs, others) if others else None
        self._ended: Flags = np.zeros(num_envs, np.bool_)

    def reset(self, mask: Flags, seeds: Sequence[int | None], options: dict[str, Any]) -> list[Info]:
        """Begins an episode in some environments; returns the info of each, empty of others.

        Args:
            mask: In which, shape (num_envs,).
            seeds: One per environment; None goes on with its random numbers.
            options: Of Gymnasium's reset, the same for all.
        """
        infos: list[Info] = [{}] * self.num_envs
        for index in np.flatnonzero(mask).tolist():
            seen, infos[index] = self.envs[index].reset(seed=seeds[index], options=options)
            self._show(index, seen)
        self._ended[mask] = False
        return infos

    def accept(self) -> tuple[()]:
        """Takes the actions of the next step, or raises as RoverEnv: a mistake changes nothing."""
        for index in self._stepped():
            self.envs[index].accept(self.rows.actions[index])
        return ()

    def step(self) -> list[Info]:
        """Steps all by the actions; returns the info of each."""
        self.accept()
        _, _, rewards, terminated, truncated = self.rows
        infos: list[Info] = [{}] * self.num_envs
        rewards.fill(0.0)
        for flags in (terminated, truncated):
            flags.fill(False)
        stepped = self._stepped()
        for index in sorted({*range(self.num_envs)} - {*stepped}):
            seen, infos[index] = self.envs[index].reset()
            self._show(index, seen)
        self._drive([self.envs[index] for index in stepped])
        for index in stepped:
            seen, rewards[index], terminated[index], truncated[index], info = self.envs[index].conclude()
            if self._mode is AutoresetMode.SAME_STEP and (terminated[index] or truncated[index]):
                final = {"final_obs": seen, "final_info": info}
                seen, info = self.envs[index].reset()
                info |= final
            self._show(index, seen)
            infos[index] = info
        self._ended = terminated | truncated
        return infos

    def render(self) -> tuple[Any, ...]:
        """Returns what each environment draws."""
        return tuple(env.render() for env in self.envs)

    def close(self) -> None:
        """Closes the environments, which ends their threads."""
        for env in self.envs:
            env.close()
        if self._pool is not None:
            self._pool.close()
            self._pool = None  # its locks are gone: who steps on does the physics alone

    def _show(self, index: int, seen: Observation) -> None:
        for name, part in self.rows.observations.items():
            part[index] = seen[name]

    def _stepped(self) -> list[int]:
        """The environments that a step drives; with NEXT_STEP, those that ended begin anew instead."""
        begun = self._ended & (self._mode is AutoresetMode.NEXT_STEP)
        return np.flatnonzero(~begun).tolist()

    def _drive(self, envs: Sequence[RoverEnv[Any]]) -> None:
        """Drives and senses, in this order, what has been accepted."""
        if self._pool is None:  # all are driven first: Python's own part stays in the processor's caches
            for env in envs:
                env.command()
            for env in envs:
                env.drive()
            for env in envs:
                env.sense()
            return
        for place in self._pool.step(map(_commanded, envs)):
            envs[place].drive()
            envs[place].sense()


def _commanded(env: RoverEnv[Any]) -> Physics:
    env.command()
    return env.driven.simulation.physics


def serve(
    connection: Connection,
    make: Callable[..., RoverEnv[Any]],
    place: tuple[Any, Shapes, int, slice],
    given: dict[str, Any],
) -> None:
    """Steps environments in a process of their own, as it is asked, until nobody listens.

    Args:
        connection: To who asks.
        make: Makes one environment.
        place: The memory, the shapes of the parts of an observation, how many environments there are in
            all, and which of them are here.
        given: Options of a Part.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's is for the parent
    if hasattr(signal, "pthread_sigmask"):  # a parent that ends without closing sends it, and waits
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGTERM])
    *memory, place_of = place
    part = Part(make, place_of.stop - place_of.start, **given)
    part.rows = Shared.of(*memory).rows(place_of)
    waited = 0.0
    with contextlib.suppress(EOFError, ConnectionError):
        while True:
            begun = time.monotonic()
            if waited < AWAKE:  # else whoever asks does something between steps, and may want this core
                stay_awake(connection)
            request, *args = connection.recv()
            waited = time.monotonic() - begun
            connection.send(answered(part, request, args))


def answered(part: Part, request: str, args: Sequence[Any]) -> "Sequence[Any] | Exception":
    """Does what is asked of the environments of a process.

    Args:
        part: They themselves.
        request: The name of what it does: "reset", "accept", "step" or "render".
        args: Of that.

    Returns:
        The info of each, or what each draws; an error that is to be raised where it was asked for.
    """
    try:
        answer: Sequence[Any] = getattr(part, request)(*args)
    except Exception as error:  # noqa: BLE001 - it is raised when all have answered
        return error
    return answer
