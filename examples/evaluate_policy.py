"""How often a policy reaches its goal in worlds that it has not seen, as a table with intervals.

python examples/evaluate_policy.py examples/point_nav.npz
"""

import argparse
import os
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import gymnasium
import numpy as np

import harness.gym  # noqa: F401 - registers
from harness.base.errors import HarnessError
from harness.base.sim_time import CONTROL_PERIOD
from harness.drivers.policy import BESIDE_LIDAR, Policy, read_policy
from harness.scenario.verdict import wilson

ID, UNSEEN = "RoverHarness/PointNav-v0", 1_000_000  # the first seed; learning begins with small ones


@dataclass(frozen=True)
class Outcome:
    """How one episode went.

    Attributes:
        ending: As the environment tells it.
        seconds: Of simulation time.
    """

    ending: str
    seconds: float


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
    return Outcome(ending, env.steps * CONTROL_PERIOD)


def straight_ahead(beams: int) -> Policy:
    """Returns a policy to compare with: to the goal without a look, slower while it turns."""
    weights = np.zeros((BESIDE_LIDAR + beams, 2), np.float32)
    weights[1], weights[2] = (0.0, 2.0), (0.9, 0.0)  # sine and cosine of the bearing
    return Policy(((weights, np.zeros(2, np.float32)),))


def row(name: str, terrain: str, outcomes: list[Outcome]) -> str:
    """Returns a line of the table."""
    endings = Counter(outcome.ending for outcome in outcomes)
    good, count = endings.pop("reached", 0), len(outcomes)
    low, high = wilson(good, count)
    failures = ", ".join(f"{ending} {number}" for ending, number in sorted(endings.items()))
    times = [outcome.seconds for outcome in outcomes if outcome.ending == "reached"]
    cells = (
        name,
        terrain,
        f"{good} of {count}",
        f"{low:.0%} to {high:.0%}",
        failures or "-",
        f"{median(times):.1f} s" if times else "-",
    )
    return f"| {' | '.join(cells)} |"


def table(policy: Policy, terrains: list[str], episodes: int, **options: object) -> Iterator[str]:
    """Yields the lines of the table, of the policy and of one that drives straight.

    Args:
        policy: What is evaluated.
        terrains: Where.
        episodes: On each terrain.
        options: Of the environment.
    """
    yield "| policy | terrain | reached | 95 % interval | else | time, median |"
    yield "|---|---|---:|---:|---|---:|"
    options["lidar_beams"] = policy.beams
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for terrain in terrains:
            for name, driver in (("learned", policy), ("straight", straight_ahead(policy.beams))):
                task = partial(drive, driver, {**options, "terrain": terrain})
                yield row(name, terrain, list(pool.map(task, range(UNSEEN, UNSEEN + episodes))))


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description="How often a policy of PointNav reaches its goal.")
    parser.add_argument("policy", type=Path, metavar="FILE.npz", help="what docs/gym.md describes")
    about = "where, default gravel and rocky"
    parser.add_argument("--terrain", nargs="+", default=["gravel", "rocky"], metavar="NAME", help=about)
    about = "on each, default %(default)s"
    parser.add_argument("--episodes", type=int, default=100, metavar="N", help=about)
    parser.add_argument("--robot", default="leo", metavar="NAME", help="default %(default)s")
    given = parser.parse_args()
    if given.episodes < 1:
        parser.error(f"--episodes {given.episodes} is not valid; give 1 or more")
    try:
        for line in table(read_policy(given.policy), given.terrain, given.episodes, robot=given.robot):
            print(line, flush=True)
    except HarnessError as error:
        parser.error(str(error))


if __name__ == "__main__":
    main()
