"""The memory that processes of environments share, and how one waits for another."""

import math
import os
import time
from multiprocessing.connection import Connection
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

AWAKE = 1e-3  # [s] in which a process that waits does not sleep

Shapes = dict[str, tuple[int, ...]]
Flags = NDArray[np.bool_]


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


def stay_awake(connection: Connection) -> None:
    """Returns when something can be received, or after AWAKE; gives way to others that want the core.

    A process that sleeps is woken late, and the one that wakes it waits for the system meanwhile.
    """
    end = time.monotonic() + AWAKE
    while not connection.poll(0) and time.monotonic() < end:
        if hasattr(os, "sched_yield"):  # not on Windows
            os.sched_yield()
