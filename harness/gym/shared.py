"""What a process of environments does, and the memory that it shares with who asks."""

import contextlib
import math
import os
import signal
import time
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from harness.gym.env import RoverEnv
from harness.gym.vector import Flags, Part

AWAKE = 1e-3  # [s] in which a process that waits does not sleep

Shapes = dict[str, tuple[int, ...]]


class Shared(NamedTuple):
    """What the processes exchange of each step, a row for each environment."""

    observations: dict[str, NDArray[np.float32]]
    actions: NDArray[np.float64]
    rewards: NDArray[np.float64]
    terminated: Flags
    truncated: Flags

    @classmethod
    def of(cls, memory: Any, shapes: Shapes, count: int) -> "Shared":  # noqa: ANN401 - a RawArray, or bytes
        """Returns views of a memory.

        Args:
            memory: A RawArray or other bytes, large enough for all.
            shapes: Of each part of an observation, by name.
            count: Of environments.
        """
        left = memoryview(memory).cast("B")

        def part(dtype: type, *shape: int) -> NDArray[Any]:
            nonlocal left
            array: NDArray[Any] = np.frombuffer(left, dtype, math.prod(shape)).reshape(shape)
            left = left[array.nbytes :]
            return array

        rewards, actions = part(np.float64, count), part(np.float64, count, 2)
        observations = {name: part(np.float32, count, *shape) for name, shape in shapes.items()}
        return cls(observations, actions, rewards, part(np.bool_, count), part(np.bool_, count))

    @staticmethod
    def size(shapes: Shapes, count: int) -> int:
        """Returns the bytes that it takes."""
        return count * (8 + 8 * 2 + 4 * sum(map(math.prod, shapes.values())) + 2)

    def rows(self, part: slice) -> "Shared":
        """Returns the rows of some environments."""
        _, actions, rewards, terminated, truncated = self
        observations = {name: array[part] for name, array in self.observations.items()}
        return Shared(observations, actions[part], rewards[part], terminated[part], truncated[part])


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
    *memory, part = place
    shared = Shared.of(*memory).rows(part)
    envs = Part(make, part.stop - part.start, **given)
    waited = 0.0
    with contextlib.suppress(EOFError, ConnectionError):
        while True:
            begun = time.monotonic()
            if waited < AWAKE:  # else whoever asks does something between steps, and may want this core
                stay_awake(connection)
            request, *args = connection.recv()
            waited = time.monotonic() - begun
            connection.send(answered(envs, shared, request, args))


def stay_awake(connection: Connection) -> None:
    """Returns when something can be received, or after AWAKE; gives way to others that want the core.

    A process that sleeps is woken late, and the one that wakes it waits for the system meanwhile.
    """
    end = time.monotonic() + AWAKE
    while not connection.poll(0) and time.monotonic() < end:
        if hasattr(os, "sched_yield"):  # not on Windows
            os.sched_yield()


def answered(
    envs: Part, shared: Shared, request: str, args: Sequence[Any]
) -> "Sequence[Any] | Exception":
    """Does what is asked of the environments of a process.

    Args:
        envs: They themselves.
        shared: Their rows of the memory.
        request: "reset", "accept", "step" or "render".
        args: Of a reset, as `reset_each` has them.

    Returns:
        The info of each, or what each draws; an error that is to be raised where it was asked for.
    """
    try:
        return _answer(envs, shared, request, args)
    except Exception as error:  # noqa: BLE001 - it is raised when all have answered
        return error


def _answer(envs: Part, shared: Shared, request: str, args: Sequence[Any]) -> Sequence[Any]:
    if request == "render":
        return envs.render()
    if request != "reset":
        envs.accept(shared.actions)
    if request == "accept":
        return ()
    if request == "step":
        for flags in (shared.terminated, shared.truncated):
            flags.fill(False)
        shared.rewards.fill(0.0)
        infos = envs.step_each(shared.rewards, shared.terminated, shared.truncated)
    else:
        infos = envs.reset_each(*args)
    for name, part in shared.observations.items():
        for row, seen in zip(part, envs.seen, strict=True):
            row[:] = seen[name]
    return infos
