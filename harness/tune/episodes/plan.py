"""Which episodes a sweep drives: every kind of contact and of ground, each robot in the same worlds.

Worlds come in pairs of the same stratum and different seeds: thresholds are chosen on one and checked
on the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np

from harness.base.errors import UsageError
from harness.drivers import find_driver, takes_goals
from harness.episode.assembly import check
from harness.robots import robot_name
from harness.spec.run import Run
from rover_metrics.errors import counted

FEWEST_EPISODES = 2  # one world to choose on, one to check on
DIFFICULTIES = (0.5, 0.2, 0.8)
MEETINGS = ("ram", "graze", "reverse_into", "swing", "pass_by")  # drivers

# Terrain and driver. Contacts and kinds of ground alternate, so that a short plan has some of each.
HAZARDS = (
    *(("posts", driver) for driver in MEETINGS),
    *(("rocky", driver) for driver in MEETINGS),
    *(("maze", driver) for driver in ("ram", "graze", "reverse_into", "pass_by", "roam")),
    ("posts", "roam"),
)
GROUNDS = (
    *((terrain, "roam") for terrain in ("gravel", "flat", "rocky", "washboard", "rolling", "marsyard")),
    ("dunes", "roam"),
    ("gravel", "wander"),
)
ROAMING = ("roam", "wander")  # who drives there; another driver can take their place
GOAL_PERIOD, FARTHEST_GOAL = 15.0, 12.0  # [s], [m] along x and y: where one that needs goals is sent
STRATA = tuple(
    stratum
    for number, hazard in enumerate(HAZARDS)
    for stratum in (hazard, *(GROUNDS[number // 2 : number // 2 + 1] if number % 2 == 0 else ()))
)


class Part(StrEnum):
    """What an episode is for; no threshold is scored as checked where it was chosen."""

    TRAIN = "train"
    TEST = "test"


@dataclass(frozen=True, slots=True)
class Planned:
    """One episode of a sweep; `index` is its place in the plan."""

    index: int
    part: Part
    run: Run

    @property
    def name(self) -> str:
        """Its name, which is that of its file too."""
        rover = self.run.rover
        driver = Path(rover.driver.partition(":")[0]).name
        return f"{self.index:04d}-{robot_name(rover.robot)}-{self.run.world.terrain}-{driver}"


def plan(
    robots: Sequence[str], episodes: int, seed: int, duration: float, driver: str = ""
) -> tuple[Planned, ...]:
    """Returns the episodes of a sweep.

    Args:
        robots: Names or folders of rovers; every one drives in all worlds.
        episodes: Number of worlds.
        seed: Of the whole sweep.
        duration: Of each episode [s].
        driver: In place of those of ROAMING; "" for these.

    Raises:
        UsageError: A value is not valid; the message names those that are.
    """
    if episodes < FEWEST_EPISODES:
        raise UsageError(
            f"{counted(episodes, 'episode')} will not do: half of them only check; give 2 or more"
        )
    if len(set(map(robot_name, robots))) < len(robots):
        raise UsageError("a robot is named twice; name each once")
    if seed < 0:
        raise UsageError(f"seed {seed} is not valid; give a whole number from 0 up")
    if driver:
        find_driver(driver)
    planned: list[Planned] = []
    for world in range(episodes):
        part = (Part.TRAIN, Part.TEST)[world % 2]
        for robot in robots:
            run = _run(robot, world, seed, duration, driver)
            check(run)
            planned.append(Planned(len(planned), part, run))
    return tuple(planned)


def _run(robot: str, world: int, seed: int, duration: float, roaming: str) -> Run:
    round_, stratum = divmod(world // 2, len(STRATA))
    terrain, driver = STRATA[stratum]
    if roaming and driver in ROAMING:
        driver = roaming
    return Run.of(
        terrain=terrain,
        robot=robot,
        driver=driver,
        seed=int(np.random.SeedSequence([seed, world]).generate_state(1)[0]),
        difficulty=DIFFICULTIES[(round_ + stratum) % len(DIFFICULTIES)],
        duration=duration,
        goals=_goals(world, seed, duration) if takes_goals(driver) else (),
    )


def _goals(world: int, seed: int, duration: float) -> tuple[tuple[float, float, float, float], ...]:
    times = np.arange(0.0, duration, GOAL_PERIOD)
    rng = np.random.default_rng([seed, world])
    places = rng.uniform(-FARTHEST_GOAL, FARTHEST_GOAL, (len(times), 2))
    return tuple((time, x, y, 0.0) for time, (x, y) in zip(times.tolist(), places.tolist(), strict=True))
