"""Worlds that a pool of threads steps: as each goes alone, and whole wherever somebody stops."""

import sys
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

import numpy as np
import pytest

from harness.base.sim_time import TICKS_PER_CONTROL
from harness.physics import pool as of_pool
from harness.physics.physics import Physics
from harness.physics.pool import Pool
from harness.physics.simulation import Simulation
from tests.harness.conftest import MakeSimulation

COUNT, STRIDE = 3, 7


def commanded(worlds: list[Simulation]) -> Iterator[Physics]:
    for number, world in enumerate(worlds):
        world.command_ahead(np.full((TICKS_PER_CONTROL, 4), 0.2 + 0.1 * number))  # millimetres a period
        yield world.physics


def drive(physics: Physics) -> None:
    physics.run(watched=False)
    for _ in physics.shown():
        pass


def drive_all(pool: Pool, worlds: list[Simulation]) -> list[int]:
    places = []
    for place in pool.step(commanded(worlds)):
        drive(worlds[place].physics)
        places.append(place)
    return sorted(places)


def interrupting(after: int) -> Callable[[FrameType, str, object], Any]:
    """Stands for Ctrl-C at a bytecode of the pool's own functions, counted from 0."""
    left = [after]

    def trace(frame: FrameType, event: str, _: object) -> Any:  # noqa: ANN401 - a trace function
        if frame.f_code.co_filename != of_pool.__file__:
            return None
        frame.f_trace_opcodes = True
        if event == "opcode":
            left[0] -= 1
            if left[0] == -1:
                raise KeyboardInterrupt
        return trace

    return trace


@pytest.mark.parametrize("threads", [1, 3])
def test_worlds_go_as_alone_and_none_is_lost_wherever_it_is_interrupted(
    make_simulation: MakeSimulation, threads: int
) -> None:
    worlds, alone = ([make_simulation() for _ in range(COUNT)] for _ in range(2))
    pool, bytecode, interrupted = Pool(COUNT, threads), 0, True
    while interrupted:
        interrupted = False
        sys.settrace(interrupting(bytecode))
        try:
            drive_all(pool, worlds)
        except KeyboardInterrupt:
            interrupted = True
        finally:
            sys.settrace(None)
        assert drive_all(pool, worlds) == list(range(COUNT))
        bytecode += STRIDE
    assert bytecode > 50 * STRIDE  # or it would say nothing
    pool.close()
    for _ in commanded(alone):
        pass
    for world, twin in zip(worlds, alone, strict=True):
        while twin.time_ns < world.time_ns:
            drive(twin.physics)
        assert world.pose.tolist() == twin.pose.tolist()
