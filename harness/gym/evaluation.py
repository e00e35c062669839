"""How often a policy reaches its goal in worlds that it has not seen, as a table with intervals."""

import os
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from statistics import median
from typing import Any

import gymnasium
import numpy as np

import harness.gym  # noqa: F401 - registers
from harness.base.sim_time import CONTROL_PERIOD
from harness.drivers.policy import BESIDE_LIDAR, Policy
from rover_metrics.analysis.statistics.summary import wilson
from rover_metrics.sheet.sheet import NONE, Sheet

TITLES = ("policy", "terrain", "reached", "95 % interval", "else", "time, median")
HOW = (
    "Beside a policy that drives straight to its goal; Wilson's intervals of the share that is reached."
)
ID, UNSEEN = "RoverHarness/PointNav-v0", 1_000_000  # the first seed; learning begins with small ones


Outcome = tuple[str, float]  # how an episode ended, and after how long [s of simulation time]


def drive(policy: Policy, options: dict[str, Any], seed: int) -> Outcome:
    """Returns how the first episode of a seed goes.

    Args:
        policy: What drives.
        options: Of the environment.
        seed: Of the world, the start and the goal.
    """
    env: Any = gymnasium.make(ID, disable_env_checker=True, **options).unwrapped
    observation, _ = env.reset(seed=seed)
    ending = ""
    while not ending:
        observation, *_, info = env.step(policy.act(observation))
        ending = info["ending"]
    return ending, env.steps * CONTROL_PERIOD


def straight_ahead(beams: int) -> Policy:
    """Returns a policy to compare with: to the goal without a look, slower while it turns."""
    weights = np.zeros((BESIDE_LIDAR + beams, 2), np.float32)
    weights[1], weights[2] = (0.0, 2.0), (0.9, 0.0)  # sine and cosine of the bearing
    return Policy(((weights, np.zeros(2, np.float32)),))


def row(name: str, terrain: str, outcomes: list[Outcome]) -> tuple[str, ...]:
    """Returns a row of the table, in the order of TITLES.

    Args:
        name: What drove.
        terrain: On which.
        outcomes: One per episode.
    """
    endings = Counter(ending for ending, _ in outcomes)
    good, count = endings.pop("reached", 0), len(outcomes)
    low, high = wilson(good, count, 0.95)
    failures = ", ".join(f"{ending} {number}" for ending, number in sorted(endings.items()))
    times = [seconds for ending, seconds in outcomes if ending == "reached"]
    return (
        name,
        terrain,
        f"{good} of {count}",
        f"{low:.0%} to {high:.0%}",
        failures or NONE,
        f"{median(times):.1f} s" if times else NONE,
    )


def table(
    policy: Policy,
    terrains: Sequence[str],
    episodes: int,
    show: Callable[[int, int], None] = lambda _, __: None,
    **options: object,
) -> Sheet:
    """Returns how a policy does, beside one that drives straight to its goal.

    Args:
        policy: What is evaluated.
        terrains: Where.
        episodes: On each terrain.
        show: Is called with the episodes that are done, and all.
        options: Of the environment.
    """
    rows: list[tuple[str, ...]] = []
    options["lidar_beams"] = policy.beams
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for terrain in terrains:
            for name, driver in (("learned", policy), ("straight", straight_ahead(policy.beams))):
                task = partial(drive, driver, {**options, "terrain": terrain})
                seeds = range(UNSEEN, UNSEEN + episodes)
                outcomes = []
                for outcome in pool.map(task, seeds):
                    outcomes.append(outcome)
                    show(len(rows) * episodes + len(outcomes), 2 * len(terrains) * episodes)
                rows.append(row(name, terrain, outcomes))
    return Sheet(TITLES, tuple(rows), "Goals reached in unseen worlds", HOW)
