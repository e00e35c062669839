"""Which episodes a sweep drives."""

from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers.policy import BESIDE_LIDAR, Policy, write_policy
from harness.tune.episodes.plan import MEETINGS, STRATA, Part, plan
from harness.tune.episodes.store import Store

ROBOTS = ("leo", "rover_zero4wd")


def test_worlds_come_in_pairs_of_one_stratum_one_to_choose_on_and_one_to_check_on() -> None:
    planned = plan(ROBOTS, 4 * len(STRATA), 7, 60.0)  # every stratum twice
    worlds = [one.run.world for one in planned]
    assert [one.index for one in planned] == list(range(8 * len(STRATA)))
    assert planned[5].name == "0005-rover_zero4wd-gravel-roam"
    assert [one.part for one in planned[:6]] == [*[Part.TRAIN] * 2, *[Part.TEST] * 2, *[Part.TRAIN] * 2]
    assert [(one.run.world.terrain, one.run.rover.driver) for one in planned[::4]] == [*STRATA * 2]
    assert worlds[0::4] == worlds[2::4]  # of a pair
    both = zip(planned[::2], planned[1::2], strict=True)  # of one world
    assert all(leo.run.alone(robot="rover_zero4wd") == zero.run for leo, zero in both)
    assert [world.difficulty for world in worlds[:12:4]] == [0.5, 0.2, 0.8]
    assert {one.run.duration for one in planned} == {60.0}
    seeds = {part: {one.run.seed for one in planned if one.part is part} for part in Part}
    others = {one.run.seed for one in plan(ROBOTS, 4 * len(STRATA), 8, 60.0)}
    assert len(seeds[Part.TRAIN] | seeds[Part.TEST] | others) == 8 * len(STRATA)


def test_hazards_and_grounds_of_every_kind_are_driven_and_alternate() -> None:
    drivers = {kind: {driver for terrain, driver in STRATA if terrain == kind} for kind in dict(STRATA)}
    assert drivers["posts"] == drivers["rocky"] == {*MEETINGS, "roam"}
    assert drivers["maze"] == {*MEETINGS, "roam"} - {"swing"}
    assert drivers["gravel"] == {"roam", "wander"}
    for ground in ("flat", "washboard", "rolling", "marsyard", "dunes"):
        assert drivers[ground] == {"roam"}
    assert len(set(STRATA)) == len(STRATA)
    short = {one.run.rover.driver for one in plan(("leo",), 8, 0, 60.0)}
    assert {"roam"} < short


@pytest.mark.parametrize(
    ("robots", "episodes", "seed", "duration", "message"),
    [
        (("leo",), 1, 0, 60.0, "give 2 or more"),
        (("leo", "leo"), 2, 0, 60.0, "twice"),
        (("leo",), 2, -1, 60.0, "seed -1 is not valid"),
        (("mars",), 2, 0, 60.0, "available: husky"),
        (("leo",), 2, 0, -5.0, "duration"),
    ],
)
def test_bad_values_are_refused(
    robots: tuple[str, ...], episodes: int, seed: int, duration: float, message: str
) -> None:
    with pytest.raises(UsageError, match=message):
        plan(robots, episodes, seed, duration)


def test_another_driver_takes_the_open_ground_with_goals_if_needed(tmp_path: Path) -> None:
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
        sent = 0 if driver == "straight" else 2 * sum(d in ("roam", "wander") for _, d in STRATA)
        assert len(goals) == 1 + sent
    assert all(max(map(abs, goal[1:3])) <= 12.0 for one in planned for goal in one.run.plan.goals)
    folder = tmp_path / "sweep"
    Store(folder, planned)
    write_policy(path, Policy((layer,), "relu"))
    with pytest.raises(UsageError, match="holds another sweep's files"):
        Store(folder, planned)
