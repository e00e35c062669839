"""Which episodes a sweep drives."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers.policy import BESIDE_LIDAR, Policy, write_policy
from harness.tune.episodes.plan import STRATA, Part, plan
from harness.tune.episodes.store import Store

ROBOTS = ("leo", "rover_zero4wd")


def test_every_robot_drives_in_the_same_worlds() -> None:
    worlds = [
        [(e.run.world.terrain, e.run.seed, e.run.world.difficulty, e.run.rover.driver) for e in planned]
        for robot in ROBOTS
        for planned in [[e for e in plan(ROBOTS, 10, 0, 60.0) if e.run.rover.robot == robot]]
    ]

    assert worlds[0] == worlds[1]
    assert len(set(worlds[0])) == 10


def test_worlds_alternate_between_train_and_test_and_turn_their_strata_and_difficulties() -> None:
    planned = plan(ROBOTS, 4 * len(STRATA), 7, 60.0)
    second = planned[5]  # of the third world

    assert [episode.index for episode in planned] == list(range(8 * len(STRATA)))
    assert second.name == "0005-rover_zero4wd-gravel-roam"
    assert second.part is Part.TRAIN
    assert planned[6].part is planned[7].part is Part.TEST
    assert second.run.duration == 60.0
    assert second.run.seed == int(np.random.SeedSequence([7, 2]).generate_state(1)[0])
    difficulties = [episode.run.world.difficulty for episode in planned[::4]]  # a pair of worlds each
    expected = [
        (0.5, 0.2, 0.8)[(turn + stratum) % 3] for turn in range(2) for stratum in range(len(STRATA))
    ]
    assert difficulties == expected
    assert [(e.run.world.terrain, e.run.rover.driver) for e in planned[::4]] == [*STRATA, *STRATA]


def test_hazards_of_every_kind_and_grounds_of_every_kind_are_driven() -> None:
    meetings = {"ram", "graze", "reverse_into", "swing", "pass_by"}
    drivers = {terrain: {d for t, d in STRATA if t == terrain} for terrain in ("posts", "rocky", "maze")}

    assert drivers == {
        "posts": meetings | {"roam"},
        "rocky": meetings | {"roam"},
        "maze": (meetings | {"roam"}) - {"swing"},
    }
    grounds = {t for t, driver in STRATA if driver == "roam"}
    assert grounds == {
        "gravel",
        "flat",
        "rocky",
        "washboard",
        "rolling",
        "marsyard",
        "dunes",
        "maze",
        "posts",
    }
    assert ("gravel", "wander") in STRATA
    assert len(set(STRATA)) == len(STRATA) == 24
    # Contacts and grounds alternate, so that a short plan has some of each.
    assert STRATA[:5] == (
        ("posts", "ram"),
        ("gravel", "roam"),
        ("posts", "graze"),
        ("posts", "reverse_into"),
        ("flat", "roam"),
    )


def test_no_seed_is_used_for_training_and_testing() -> None:
    planned = plan(ROBOTS, 64, 0, 60.0)
    seeds = {part: {e.run.seed for e in planned if e.part is part} for part in Part}

    assert len(seeds[Part.TRAIN]) == len(seeds[Part.TEST]) == 32
    assert not seeds[Part.TRAIN] & seeds[Part.TEST]


def test_both_parts_have_the_same_strata() -> None:
    planned = plan(("leo",), 64, 0, 60.0)
    kinds = {
        part: Counter(
            (e.run.world.terrain, e.run.rover.driver, e.run.world.difficulty)
            for e in planned
            if e.part is part
        )
        for part in Part
    }

    assert kinds[Part.TRAIN] == kinds[Part.TEST]


def test_a_full_plan_has_every_stratum_and_a_short_one_contacts_and_ground() -> None:
    full = {(e.run.world.terrain, e.run.rover.driver) for e in plan(("leo",), 2 * len(STRATA), 0, 60.0)}
    short = {e.run.rover.driver for e in plan(("leo",), 8, 0, 60.0)}

    assert full == set(STRATA)
    assert "roam" in short
    assert short - {"roam"}


def test_another_seed_gives_other_worlds() -> None:
    first, second = ({e.run.seed for e in plan(("leo",), 8, seed, 60.0)} for seed in (0, 1))

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


def test_another_driver_takes_the_open_ground_and_is_told_goals_if_it_needs_them(tmp_path: Path) -> None:
    path = tmp_path / "still.npz"
    layer = np.zeros((BESIDE_LIDAR + 640, 2), np.float32), np.zeros(2, np.float32)
    write_policy(path, Policy((layer,)))
    usual = plan(ROBOTS, 2 * len(STRATA), 3, 40.0)
    for driver in ("straight", f"policy:{path}"):
        planned = plan(ROBOTS, 2 * len(STRATA), 3, 40.0, driver)
        for ours, theirs in zip(planned, usual, strict=True):
            other = theirs.run.rover.driver in ("roam", "wander")
            assert ours.run.rover.driver == (driver if other else theirs.run.rover.driver)
            times = [time for time, *_ in ours.run.plan.goals]
            assert times == ([0.0, 15.0, 30.0] if other and driver != "straight" else [])
            assert "/" not in ours.name
        goals = {one.run.plan.goals for one in planned if one.run.rover.robot == "leo"}
        assert len(goals) == (
            1 if driver == "straight" else 1 + 2 * sum(d in ("roam", "wander") for _, d in STRATA)
        )
    assert all(max(map(abs, goal[1:3])) <= 12.0 for one in planned for goal in one.run.plan.goals)

    folder = tmp_path / "sweep"
    Store(folder, planned)
    write_policy(path, Policy((layer,), "relu"))
    with pytest.raises(UsageError, match="holds another sweep's files"):
        Store(folder, planned)
