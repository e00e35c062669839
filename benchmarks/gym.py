"""Steps of learning environments a second: alone, many at once, on two processors; and their resets.

In processor time, which says on a shared machine too what a step takes; two threads by the wall's clock.
"""

import copy
import itertools
import os
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from operator import call
from typing import Any
from unittest.mock import patch

import gymnasium
import mujoco
import numpy as np
from numpy.typing import NDArray

import harness.gym  # noqa: F401 - registers
from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.resident import MEGABYTE, resident
from harness.base.sim_time import CONTROL_PERIOD, TICKS_PER_CONTROL
from harness.robots import ROVERS

ID = "RoverHarness/PointNav-v0"
COUNTS = (1, 16, 64)
ON_TWO = 16  # environments on two processors
MOST_ROUNDS = 3
SHARE = 1 / 20  # of the simulated seconds of other runs
STEPS_A_WORLD = 50
LONGER = 1.25  # than physics alone, a vector at most
WHERE = {"goal": (15.0, 15.0)}  # far away: no episode ends
PLAIN: dict[str, Any] = {
    "random_start": False,
    "time_limit": 1e6,
    "hazard_budget": 1e6,
    "episodes_per_world": 10**6,
}


def measure(effort: Effort) -> Table:
    """Of each robot on the default terrain, with all 640 beams."""
    seconds = max(effort.seconds * SHARE, CONTROL_PERIOD)
    effort = replace(effort, rounds=min(effort.rounds, MOST_ROUNDS), seconds=seconds)
    robots = list(ROVERS)[: effort.maps]  # worlds take their time to make
    rows = [row for robot in robots for row in _rows(robot, effort)]
    return Table(
        title=f"Learning environments: PointNav on rocky, {effort.seconds:g} simulated seconds, "
        f"{effort.rounds} rounds",
        columns=("robot", "what", "env steps a second", "time against physics alone", "target"),
        rows=tuple(rows),
    )


def _rows(robot: str, effort: Effort) -> list[tuple[str, ...]]:
    steps = round(effort.seconds / CONTROL_PERIOD)
    actions = np.random.default_rng(0).uniform((0.4, -0.2), (0.8, 1.0), (steps, 2)).astype(np.float32)
    env: Any = gymnasium.make(ID, disable_env_checker=True, robot=robot, **PLAIN).unwrapped
    env.reset(seed=0)
    commands = _recorded(env, actions)
    ways: dict[str, tuple[int, Callable[[], float]]] = {
        "physics alone": (1, lambda: _physics(env, commands)),
        "one environment": (1, _driving(env, actions)),
    }
    for count in COUNTS if effort.rounds > 1 else COUNTS[:1]:
        ways[f"vector of {count}"] = (count, _vector(robot, count, 1, actions))
    rounds = Rounds({name: run for name, (_, run) in ways.items()}, effort.rounds)
    targets = {"physics alone": "-", "one environment": ">= 1,000 a second"}
    rows = []
    for name, (count, _) in ways.items():
        against = f"**{rounds.ratio(name, 'physics alone') / count:.2f}**"
        speed = f"{count * steps / rounds.median(name):,.0f}"
        rows.append((robot, name, speed, against, targets.get(name, f"<= {LONGER:.2f}")))
    both = [_physics_on_two(robot, env, commands, effort), _on_two(robot, actions, effort)]
    return [*rows, *both, *_resets(robot, env, effort), _memory(robot, env, effort)]


def _on_two(robot: str, actions: NDArray[np.float32], effort: Effort) -> tuple[str, ...]:
    """How much sooner two threads are done than one, on a machine with two free processors."""
    count = ON_TWO if effort.rounds > 1 else 2
    ways = {str(n): _vector(robot, count, n, actions, time.perf_counter) for n in (1, 2)}
    what, steps = f"vector of {count}", count * len(actions)
    return _two_against_one(robot, what, steps, Rounds(ways, effort.rounds), ">= 1.80")


def _physics_on_two(
    robot: str,
    env: Any,  # noqa: ANN401
    commands: list[NDArray[np.float64]],
    effort: Effort,
) -> tuple[str, ...]:
    """Likewise of threads that do nothing but steps of MuJoCo: all that the machine can give."""
    other = copy.deepcopy(env)
    other.reset(seed=0)
    periods = np.reshape(commands, (-1, TICKS_PER_CONTROL, len(commands[0])))

    def stepping(each: Any) -> Callable[[], None]:  # noqa: ANN401
        each.reset(options=WHERE)
        simulation = each.driven.simulation

        def run() -> None:
            for period in periods:
                simulation.command_ahead(period)
                simulation.physics.run(watched=False)

        return run

    def drive(threads: int) -> float:
        drives = [stepping(each) for each in (env, other)]
        with ThreadPoolExecutor(threads) as pool:
            return timed(lambda: list(pool.map(call, drives)))()

    ways = {str(n): partial(drive, n) for n in (1, 2)}
    return _two_against_one(robot, "physics alone", 2 * len(periods), Rounds(ways, effort.rounds), "-")


def _two_against_one(robot: str, what: str, steps: int, rounds: Rounds, target: str) -> tuple[str, ...]:
    speed, sooner = steps / rounds.median("2"), f"**{rounds.ratio('1', '2'):.2f}** times as fast as 1"
    return robot, f"{what}, 2 threads, wall time", f"{speed:,.0f}", f"{sooner} thread", target


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


def _recorded(env: Any, actions: NDArray[np.float32]) -> list[NDArray[np.float64]]:  # noqa: ANN401
    """The wheel commands of a drive, tick by tick."""
    env.reset(options=WHERE)
    simulation = env.driven.simulation
    with patch.object(simulation, "command_ahead", wraps=simulation.command_ahead) as spy:
        for action in actions:
            env.step(action)
    return [speeds for call in spy.call_args_list for speeds in call.args[0]]


def _physics(env: Any, commands: list[NDArray[np.float64]]) -> float:  # noqa: ANN401
    """Processor time [s] of mj_step alone under these commands: the same contacts, the same path."""
    env.reset(options=WHERE)
    simulation = env.driven.simulation

    def run() -> None:
        for speeds in commands:
            simulation.command_wheels(speeds)
            mujoco.mj_step(simulation.model, simulation.data, simulation.steps_per_tick)

    return timed(run, time.process_time)()


def _driving(env: Any, actions: NDArray[np.float32]) -> Callable[[], float]:  # noqa: ANN401
    def drive() -> None:
        for action in actions:
            env.step(action)

    return _from_the_start(env, drive, time.process_time)


def _vector(
    robot: str,
    count: int,
    threads: int,
    actions: NDArray[np.float32],
    clock: Callable[[], float] = time.process_time,
) -> Callable[[], float]:
    """All in the same place with the same actions, so that their physics costs what that of one does."""
    envs: Any = gymnasium.make_vec(ID, num_envs=count, threads=threads, robot=robot, **PLAIN)
    envs.reset(seed=[0] * count)
    all_actions = np.repeat(actions[:, None], count, axis=1)

    def drive() -> None:
        for each in all_actions:
            envs.step(each)

    return _from_the_start(envs, drive, clock)


def _from_the_start(
    env: Any,  # noqa: ANN401
    drive: Callable[[], None],
    clock: Callable[[], float],
) -> Callable[[], float]:
    def measured() -> float:
        env.reset(options=WHERE)
        return timed(drive, clock)()

    return measured
