"""Steps of learning environments a second: alone, many at once, on two cores; and their resets.

In processor time, which says on a shared machine too what a step takes; on two cores by the wall's
clock.
"""

import itertools
import os
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import partial
from multiprocessing import get_context
from typing import Any
from unittest.mock import patch

import gymnasium
import mujoco
import numpy as np
from gymnasium.error import DependencyNotInstalled
from numpy.typing import NDArray

import harness.gym  # noqa: F401 - registers
from benchmarks.measuring import Effort, Rounds, Table, against, timed
from benchmarks.resident import MEGABYTE, resident
from harness.base.sim_time import CONTROL_PERIOD

ID = "RoverHarness/PointNav-v0"
MANY = 16  # environments at once
PHYSICS, ANT = "physics alone", "Ant-v5"
ONE_GOAL, MANY_GOAL = 0.85, 0.90  # of the speed of physics alone, at least
ROBOTS = ("leo", "rover_zero4wd")
MOST_ROUNDS = 3
SHARE = 1 / 20  # of the simulated seconds of other runs
STEPS_A_WORLD = 50
WHERE = {"goal": (15.0, 15.0)}  # far away: no episode ends
PLAIN: dict[str, Any] = {
    "random_start": False,
    "time_limit": 1e6,
    "hazard_budget": 1e6,
    "episodes_per_world": 10**6,
}

Commands = list[NDArray[np.float64]]
Ways = dict[str, tuple[int, float, Callable[[], float]]]  # see _against_first


def measure(effort: Effort) -> Table:
    """Of each robot on the default terrain, with all 640 beams, and of Gymnasium's Ant-v5."""
    seconds = max(effort.seconds * SHARE, CONTROL_PERIOD)
    effort = replace(effort, rounds=min(effort.rounds, MOST_ROUNDS), seconds=seconds)
    robots = ROBOTS[: effort.maps]  # worlds take their time to make
    rows = [row for robot in robots for row in _rows(robot, effort)]
    return Table(
        title=f"Learning environments: PointNav on rocky, {effort.seconds:g} simulated seconds, "
        f"{effort.rounds} rounds",
        columns=("robot", "what", "env steps a second", "speed against physics alone", "target"),
        rows=(*rows, *_ant(effort)),
    )


def _rows(robot: str, effort: Effort) -> list[tuple[str, ...]]:
    steps = round(effort.seconds / CONTROL_PERIOD)
    actions = np.random.default_rng(0).uniform((0.4, -0.2), (0.8, 1.0), (steps, 2)).astype(np.float32)
    env: Any = gymnasium.make(ID, disable_env_checker=True, robot=robot, **PLAIN).unwrapped
    env.reset(seed=0)
    commands, many = _recorded(env, actions), MANY if effort.rounds > 1 else 2
    ways: Ways = {
        PHYSICS: (1, 0.0, partial(_physics, env, commands)),
        "one environment": (1, ONE_GOAL, _from_the_start(env, actions)),
        f"vector of {many}": (many, MANY_GOAL, _vector(robot, many, actions, threads=1)),
    }
    rows = _against_first(robot, steps, ways, effort)
    with ProcessPoolExecutor(2, get_context("spawn"), _prepare, (robot, commands)) as pool:
        max(pool.map(_one_drive, [1] * 4))  # both have begun
        of_each = [many // 2] * 2
        ways = {
            f"{PHYSICS}, 2 processes": (many, 0.0, lambda: max(pool.map(_one_drive, of_each))),
            f"vector of {many}, threads": (many, MANY_GOAL, _vector(robot, many, actions, threads=0)),
            f"vector of {many}, 2 processes": (
                many,
                MANY_GOAL,
                _vector(robot, many, actions, processes=2),
            ),
        }
        rows += _against_first(robot, steps, ways, effort)
    return [*rows, *_resets(robot, env, effort), _memory(robot, env, effort)]


def _against_first(robot: str, steps: int, ways: Ways, effort: Effort) -> list[tuple[str, ...]]:
    """A row for each way, by its count of environments, its goal and what takes its time."""
    rounds = Rounds({name: run for name, (*_, run) in ways.items()}, effort.rounds)
    first, (first_count, *_) = next(iter(ways.items()))
    return [
        (
            robot,
            name,
            f"{count * steps / rounds.median(name):,.0f}",
            against(rounds.ratio(first, name) * count / first_count, goal),
            f">= {goal:.2f}" if goal else "-",
        )
        for name, (count, goal, _) in ways.items()
    ]


def _ant(effort: Effort) -> list[tuple[str, ...]]:
    """What Gymnasium's own environment of a robot on a plane has of its physics' speed."""
    try:
        env: Any = gymnasium.make(
            ANT, disable_env_checker=True, terminate_when_unhealthy=False
        ).unwrapped
    except (DependencyNotInstalled, ImportError) as error:
        return [(ANT, f"skipped: {error}; it needs gymnasium's extra mujoco", "-", "-", "-")]
    steps = round(effort.seconds / CONTROL_PERIOD)
    actions = np.random.default_rng(0).uniform(-1.0, 1.0, (steps, 8))

    def physics() -> None:
        for action in actions:
            env.data.ctrl[:] = action
            mujoco.mj_step(env.model, env.data, env.frame_skip)

    def drive() -> None:
        for action in actions:
            env.step(action)

    def from_the_start(work: Callable[[], None]) -> float:
        env.reset(seed=0)
        return timed(work, time.process_time)()

    ways: Ways = {
        PHYSICS: (1, 0.0, partial(from_the_start, physics)),
        "one environment": (1, 0.0, partial(from_the_start, drive)),
    }
    return _against_first(ANT, steps, ways, effort)


def _resets(robot: str, env: Any, effort: Effort) -> list[tuple[str, ...]]:  # noqa: ANN401
    seeds = itertools.count(1)
    here, there = {"start": (1.0, 0.5, 1.0)}, itertools.cycle([(1.0, 0.5, 1.1), (0.9, 0.5, 1.0)])
    env.reset(options=here)
    ways: dict[str, tuple[str, Callable[[], object]]] = {
        "reset where it stood": ("<= 20 ms", lambda: env.reset(options=here)),
        "reset elsewhere in the world": ("<= 20 ms", lambda: env.reset(options={"start": next(there)})),
        "reset in a new world": ("<= 200 ms", lambda: env.reset(seed=next(seeds))),
    }
    rounds = [
        Rounds({name: timed(work, time.process_time)}, effort.rounds) for name, (_, work) in ways.items()
    ]
    return [
        (robot, name, "-", f"{1e3 * measured.median(name):.0f} ms", target)
        for (name, (target, _)), measured in zip(ways.items(), rounds, strict=True)
    ]


def _memory(robot: str, env: Any, effort: Effort) -> tuple[str, ...]:  # noqa: ANN401
    """What worlds, episodes and steps add to the process once there have been some."""
    seeds, count = itertools.count(1000), 10 * effort.rounds if effort.rounds > 1 else 1

    def drive(worlds: int) -> float:
        for seed in itertools.islice(seeds, worlds):
            env.reset(seed=seed)
            env.reset()
            for _ in range(STEPS_A_WORLD):
                env.step(np.array([0.5, 0.2], np.float32))
        return resident(os.getpid())

    begun = drive(count)
    grown = (drive(count) - begun) / MEGABYTE
    what = f"memory after {count} worlds, {count * STEPS_A_WORLD:,} steps"
    return robot, what, "-", f"{grown:+.1f} MB", "< 5 MB"


def _recorded(env: Any, actions: NDArray[np.float32]) -> Commands:  # noqa: ANN401
    """The wheel commands of a drive, tick by tick."""
    env.reset(options=WHERE)
    simulation = env.driven.simulation
    with patch.object(simulation, "command_ahead", wraps=simulation.command_ahead) as spy:
        for action in actions:
            env.step(action)
    return [speeds for call in spy.call_args_list for speeds in call.args[0]]


def _physics(
    env: Any,  # noqa: ANN401
    commands: Commands,
    clock: Callable[[], float] = time.process_time,
) -> float:
    """Time [s] of mj_step alone under these commands: the same contacts, the same path."""
    env.reset(options=WHERE)
    simulation = env.driven.simulation

    def run() -> None:
        for speeds in commands:
            simulation.command_wheels(speeds)
            mujoco.mj_step(simulation.model, simulation.data, simulation.steps_per_tick)

    return timed(run, clock)()


_prepared: list[tuple[Any, Commands]] = []  # in a process that does nothing but physics


def _prepare(robot: str, commands: Commands) -> None:
    env: Any = gymnasium.make(ID, disable_env_checker=True, robot=robot, **PLAIN).unwrapped
    env.reset(seed=0)
    _prepared.append((env, commands))


def _one_drive(times: int) -> float:
    """Drives so many times; what the resets in between take does not count."""
    return sum(_physics(*_prepared[0], time.perf_counter) for _ in range(times))


def _vector(
    robot: str,
    count: int,
    actions: NDArray[np.float32],
    **workers: Any,  # noqa: ANN401 - of the vector
) -> Callable[[], float]:
    """All in the same place with the same actions, so that their physics costs what that of one does."""
    envs: Any = gymnasium.make_vec(ID, num_envs=count, robot=robot, **workers, **PLAIN)
    envs.reset(seed=[0] * count)
    clock = time.process_time if workers.get("threads") == 1 else time.perf_counter
    return _from_the_start(envs, np.repeat(actions[:, None], count, axis=1), clock)


def _from_the_start(
    env: Any,  # noqa: ANN401
    actions: NDArray[np.float32],
    clock: Callable[[], float] = time.process_time,
) -> Callable[[], float]:
    def drive() -> None:
        for action in actions:
            env.step(action)

    def measured() -> float:
        env.reset(options=WHERE)
        return timed(drive, clock)()

    return measured
