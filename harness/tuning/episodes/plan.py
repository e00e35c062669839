"""Which episodes a sweep drives: every kind of contact and of ground, each robot in the same worlds.

Worlds come in pairs of the same stratum and different seeds: thresholds are chosen on one and checked
on the other.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from harness.config import EpisodeConfig
from harness.errors import UsageError
from harness.robots import robot_name

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
    config: EpisodeConfig

    @property
    def name(self) -> str:
        """Its name, which is that of its file too."""
        config = self.config
        return f"{self.index:04d}-{robot_name(config.robot)}-{config.terrain}-{config.driver}"


def plan(robots: Sequence[str], episodes: int, seed: int, duration: float) -> tuple[Planned, ...]:
    """Returns the episodes of a sweep.

    Args:
        robots: Names or folders of rovers; every one drives in all worlds.
        episodes: Number of worlds.
        seed: Of the whole sweep.
        duration: Of each episode [s].

    Raises:
        UsageError: A value is not valid; the message names those that are.
    """
    if episodes < FEWEST_EPISODES:
        raise UsageError(f"{episodes} episodes are not enough: half of them only check; give 2 or more")
    if len(set(map(robot_name, robots))) < len(robots):
        raise UsageError("a robot is named twice; name each once")
    if seed < 0:
        raise UsageError(f"seed {seed} is not valid; give a whole number from 0 up")
    planned = [
        Planned(
            world * len(robots) + place,
            (Part.TRAIN, Part.TEST)[world % 2],
            _config(robot, world, seed, duration),
        )
        for world in range(episodes)
        for place, robot in enumerate(robots)
    ]
    for episode in planned:
        episode.config.validate()
    return tuple(planned)


def _config(robot: str, world: int, seed: int, duration: float) -> EpisodeConfig:
    round_, stratum = divmod(world // 2, len(STRATA))
    terrain, driver = STRATA[stratum]
    return EpisodeConfig(
        terrain=terrain,
        robot=robot,
        driver=driver,
        seed=int(np.random.SeedSequence([seed, world]).generate_state(1)[0]),
        difficulty=DIFFICULTIES[(round_ + stratum) % len(DIFFICULTIES)],
        duration=duration,
    )
