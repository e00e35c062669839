"""Steps of learning environments a second: alone, many at once, on two processors; and their resets."""

import itertools
import os
from collections.abc import Callable
from typing import Any
from unittest.mock import patch

import gymnasium
import mujoco
import numpy as np
from numpy.typing import NDArray

import harness.gym  # noqa: F401 - registers
from benchmarks.measuring import Effort, Rounds, Table, timed
from benchmarks.resident import MEGABYTE, resident
from harness.drivers.base import CONTROL_PERIOD
from harness.robots import ROVERS

ID = "RoverHarness/PointNav-v0"
COUNTS = (1, 4, 16, 64)
ON_TWO = 16  # environments on two processors
STEPS_A_WORLD = 50
SLOW = 1.0 / 1.25  # of what physics alone does, a vector at least
WHERE = {"goal": (15.0, 15.0)}  # far away: no episode ends
PLAIN: dict[str, Any] = {
    "random_start": False,
    "time_limit": 1e6,
    "hazard_budget": 1e6,
    "episodes_per_world": 10**6,
}


def measure(effort: Effort) -> Table:
    """Of each robot on the default terrain, with all 640 beams."""
    robots = list(ROVERS)[: effort.maps]  # worlds take their time to make
    rows = [row for robot in robots for row in _rows(robot, effort)]
    return Table(
        title=f"Learning environments: PointNav on rocky, {effort.seconds / 4:g} simulated seconds",
        columns=("robot", "what", "env steps a second", "speed against physics alone", "target"),
        rows=tuple(rows),
    )


def _rows(robot: str, effort: Effort) -> list[tuple[str, ...]]:
    steps = round(effort.seconds / 4 / CONTROL_PERIOD)
    actions = np.random.default_rng(0).uniform((0.4, -0.2), (0.8, 1.0), (steps, 2)).astype(np.float32)
    env: Any = gymnasium.make(ID, disable_env_checker=True, robot=robot, **PLAIN).unwrapped
    env.reset(seed=0)
    commands = _recorded(env, actions)
    counts = COUNTS if effort.rounds > 1 else COUNTS[:1]
    many = ON_TWO if effort.rounds > 1 else 2
    ways: dict[str, tuple[int, Callable[[], float]]] = {
        "physics alone": (1, lambda: _physics(env, commands)),
        "one environment": (1, _driving(env, actions)),
    }
    for count in counts:
        ways[f"vector of {count}"] = (count, _vector(robot, count, 1, actions))
    both = f"vector of {many}, 2 threads"
    ways[both] = (many, _vector(robot, many, 2, actions))
    rounds = Rounds({name: run for name, (_, run) in ways.items()}, effort.rounds)
    targets = {"one environment": ">= 1,000 a second", both: f"{1.8 * SLOW:.2f}"}
    rows = []
    for name, (count, _) in ways.items():
        target = targets.get(name, f">= {SLOW:.2f}" if name.startswith("vector") else "-")
        against = f"**{count * rounds.ratio('physics alone', name):.2f}**"
        rows.append((robot, name, f"{count * steps / rounds.median(name):,.0f}", against, target))
    return [*rows, *_resets(robot, env, effort), _memory(robot, env, effort)]


def _resets(robot: str, env: Any, effort: Effort) -> list[tuple[str, ...]]:  # noqa: ANN401
    seeds = itertools.count(1)
    rounds = Rounds(
        {
            "reset in the same world": timed(lambda: env.reset(options={"start": (1.0, 0.5, 1.0)})),
            "reset in a new world": timed(lambda: env.reset(seed=next(seeds))),
        },
        effort.rounds,
    )
    targets = {"reset in the same world": "<= 20 ms", "reset in a new world": "<= 200 ms"}
    return [(robot, n, "-", f"{1e3 * rounds.median(n):.0f} ms", target) for n, target in targets.items()]


def _memory(robot: str, env: Any, effort: Effort) -> tuple[str, ...]:  # noqa: ANN401
    """What worlds, episodes and steps add to the process once there have been some."""
    seeds, count = itertools.count(1000), 10 * effort.rounds

    def drive(worlds: int) -> float:
        for seed in itertools.islice(seeds, worlds):
            env.reset(seed=seed)
            env.reset()
            for _ in range(STEPS_A_WORLD):
                env.step(np.array([0.5, 0.2], np.float32))
        return resident(os.getpid())

    begun = drive(4 * effort.rounds)
    grown = (drive(count) - begun) / MEGABYTE
    what = f"memory after {count} worlds, {count * STEPS_A_WORLD:,} steps"
    return robot, what, "-", f"{grown:+.1f} MB", "< 5 MB"


def _recorded(env: Any, actions: NDArray[np.float32]) -> list[NDArray[np.float64]]:  # noqa: ANN401
    """The wheel commands of a drive, tick by tick."""
    env.reset(options=WHERE)
    leap = env._ride._leap  # noqa: SLF001 - to compare with what it does
    with patch.object(leap, "run", wraps=leap.run) as spy:
        for action in actions:
            env.step(action)
    return [speeds for call in spy.call_args_list for speeds in call.args[0]]


def _physics(env: Any, commands: list[NDArray[np.float64]]) -> float:  # noqa: ANN401
    """Wall time [s] of mj_step alone under these commands: the same contacts, the same path."""
    env.reset(options=WHERE)
    simulation = env._ride.simulation  # noqa: SLF001

    def run() -> None:
        for speeds in commands:
            simulation.command_wheels(speeds)
            mujoco.mj_step(simulation.model, simulation.data, simulation.steps_per_tick)

    return timed(run)()


def _driving(env: Any, actions: NDArray[np.float32]) -> Callable[[], float]:  # noqa: ANN401
    def drive() -> None:
        for action in actions:
            env.step(action)

    return _from_the_start(env, drive)


def _vector(robot: str, count: int, threads: int, actions: NDArray[np.float32]) -> Callable[[], float]:
    """All in the same place with the same actions, so that their physics costs what that of one does."""
    envs: Any = gymnasium.make_vec(ID, num_envs=count, threads=threads, robot=robot, **PLAIN)
    envs.reset(seed=[0] * count)
    all_actions = np.repeat(actions[:, None], count, axis=1)

    def drive() -> None:
        for each in all_actions:
            envs.step(each)

    return _from_the_start(envs, drive)


def _from_the_start(env: Any, drive: Callable[[], None]) -> Callable[[], float]:  # noqa: ANN401
    def measured() -> float:
        env.reset(options=WHERE)
        return timed(drive)()

    return measured
