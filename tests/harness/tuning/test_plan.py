"""Which episodes a sweep drives."""

from collections import Counter

import pytest

from harness.errors import UsageError
from harness.tuning.plan import STRATA, Part, plan

ROBOTS = ("leo", "rover_zero4wd")


def test_every_robot_drives_in_the_same_worlds() -> None:
    worlds = [
        [(e.config.terrain, e.config.seed, e.config.difficulty, e.config.driver) for e in planned]
        for robot in ROBOTS
        for planned in [[e for e in plan(ROBOTS, 10, 0, 60.0) if e.config.robot == robot]]
    ]

    assert worlds[0] == worlds[1]
    assert len(set(worlds[0])) == 10


def test_no_seed_is_used_for_choosing_and_checking() -> None:
    planned = plan(ROBOTS, 64, 0, 60.0)
    seeds = {part: {e.config.seed for e in planned if e.part is part} for part in Part}

    assert len(seeds[Part.CHOOSING]) == len(seeds[Part.CHECKING]) == 32
    assert not seeds[Part.CHOOSING] & seeds[Part.CHECKING]


def test_both_parts_have_the_same_strata() -> None:
    planned = plan(("leo",), 64, 0, 60.0)
    kinds = {
        part: Counter(
            (e.config.terrain, e.config.driver, e.config.difficulty) for e in planned if e.part is part
        )
        for part in Part
    }

    assert kinds[Part.CHOOSING] == kinds[Part.CHECKING]


def test_a_full_plan_has_every_stratum_and_a_short_one_contacts_and_ground() -> None:
    full = {(e.config.terrain, e.config.driver) for e in plan(("leo",), 2 * len(STRATA), 0, 60.0)}
    short = {e.config.driver for e in plan(("leo",), 8, 0, 60.0)}

    assert full == set(STRATA)
    assert "roam" in short
    assert short - {"roam"}


def test_another_seed_gives_other_worlds() -> None:
    first, second = ({e.config.seed for e in plan(("leo",), 8, seed, 60.0)} for seed in (0, 1))

    assert not first & second


@pytest.mark.parametrize(
    ("robots", "episodes", "seed", "duration", "message"),
    [
        (("leo",), 1, 0, 60.0, "give 2 or more"),
        (("leo", "leo"), 2, 0, 60.0, "twice"),
        (("leo",), 2, -1, 60.0, "seed -1 is not valid"),
        (("mars",), 2, 0, 60.0, "available: leo"),
        (("leo",), 2, 0, -5.0, "duration"),
    ],
)
def test_bad_values_are_refused(
    robots: tuple[str, ...], episodes: int, seed: int, duration: float, message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        plan(robots, episodes, seed, duration)
