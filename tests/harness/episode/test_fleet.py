"""What --rover says, and who starts where."""

import math
from dataclasses import replace

import numpy as np
import pytest
from harness.episode.fleet import MOST_ROVERS, fleet_of_words, scenery

from harness.base.errors import UsageError
from harness.episode.episode import fleet_of, together
from harness.robots import find_rover
from harness.samples import ActorPoses, Place, TruthState
from harness.spec.run import Run
from harness.world.berths import GAP
from tests.support.rovers import LEO

FLAT = Run.of(terrain="flat")


def test_each_rover_has_its_own_of_what_is_told_of_it_and_the_rest_is_shared() -> None:
    shared = replace(FLAT, seed=3, noise="white", start=(1.0, 2.0, 0.5), faults=("imu:nan@1",))
    places, others = "x=-2,y=1.5,yaw=-1", "driver=straight,noise=hardware,sensors=gnss+depth=small"
    faults = "fault=scan:dropout=0.5@2,fault=gnss:nan"
    words = ("leo", f"rover_zero4wd:z,{places},{others},{faults}")
    one, other = fleet_of_words(words, shared)
    assert one == replace(shared, robot="leo", name="rover1", world_robot="leo")
    assert other == replace(
        shared,
        robot="rover_zero4wd",
        name="z",
        number=1,
        world_robot="leo",
        start=(-2.0, 1.5, -1.0),
        driver="straight",
        noise="hardware",
        sensors=("gnss", "depth=small"),
        faults=("imu:nan@1", "scan:dropout=0.5@2", "gnss:nan"),
    )


def test_goals_and_the_timeout_of_commands_are_of_those_who_heed_them() -> None:
    shared = replace(FLAT, goal_area=(-3.0, 3.0, -3.0, 3.0), cmd_vel_timeout=0.5)
    goal, told, free = fleet_of_words(
        ("leo:a,driver=goal", "leo:b,driver=cmd_vel,x=2,y=0", "leo:c,x=4,y=0"), shared
    )
    assert [each.goal_area is not None for each in (goal, told, free)] == [True, False, False]
    assert [each.cmd_vel_timeout for each in (goal, told, free)] == [None, 0.5, None]
    with pytest.raises(UsageError, match="cmd-vel-timeout"):
        fleet_of_words(("leo:a",), replace(FLAT, cmd_vel_timeout=0.5))


def test_who_has_no_start_stands_beside_the_first_and_nobody_touches() -> None:
    words = ("leo", "rover_zero4wd", f"leo:near,x=0,y={LEO.reach * 2 + GAP:.3f}", "leo", "leo")
    fleet = fleet_of_words(words, FLAT)
    world, members = scenery(fleet)
    assert members[0].start == world.start
    for number, one in enumerate(members):
        for other in members[:number]:
            apart = math.dist(one.start[:2], other.start[:2])
            assert apart >= one.rover.reach + other.rover.reach + GAP - 1e-3
    assert fleet == fleet_of_words(words, FLAT)


def test_the_first_ones_randomness_is_that_of_a_single_run_and_all_differ() -> None:
    fleet = fleet_of_words(("leo:x", "leo:y,x=2,y=0", "leo:z,x=4,y=0"), replace(FLAT, seed=7))
    seeds = [each.own_seed for each in fleet]
    assert seeds[0] == 7
    assert len(set(seeds)) == 3
    expected = np.random.SeedSequence(7, spawn_key=(13, 2)).generate_state(4)
    assert seeds[2] == sum(int(word) << 32 * n for n, word in enumerate(expected))


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("leo:a", "leo:a"), "two rovers are called 'a'; give each a name of its own"),
        (("leo:a", "leo:1x"), "'1x' is no name in ROS; give letters, digits and _"),
        (("leo:a b",), "'a b' is no name in ROS"),
        (("nope:a",), "robot 'nope' does not exist; available: leo"),
        (("leo,z=3",), "'z=3' is not known; available: x, y, yaw, driver"),
        (("leo,fast",), "'fast' is not known; available"),
        (("leo,x=1",), "a start needs x and y"),
        (("leo,yaw=1",), "a start needs x and y"),
        (("leo,x=q,y=1",), "x 'q' is no number; give metres"),
        (("leo", "leo,x=nan,y=0"), "start nan,0,0 is not valid"),
        (("leo", "leo,fault=clock:freeze@1"), "there is one clock for all; give its faults as --fault"),
        (("leo", "leo,x=2,y=2,driver=ram"), "driver 'ram' on flat: it drives into hazards"),
        (("leo", "leo,driver=fly"), "driver 'fly' does not exist; available: wander"),
        (("leo",) * (MOST_ROVERS + 1), "17 rovers are too many for a world; give 16 at most"),
    ],
)
def test_a_mistake_is_told_in_a_line_that_says_what_is_valid(words: tuple[str, ...], told: str) -> None:
    with pytest.raises(UsageError) as refused:
        fleet_of(fleet_of_words(words, FLAT))
    assert told in str(refused.value)
    assert "\n" not in str(refused.value)


def test_where_there_is_no_room_the_mend_names_the_rover(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("harness.episode.fleet.berth", lambda *_: None)
    with pytest.raises(
        UsageError, match="no room for b near the start of a; give it one: --rover leo:b,"
    ):
        fleet_of_words(("leo:a", "leo:b"), FLAT)


def test_a_rover_whose_place_is_taken_is_put_beside_who_stands_there() -> None:
    """The other stands on; people walk on; both are seen to touch nothing."""
    shared = replace(FLAT, duration=0.3, lidar_beams=2, driver="straight", actors=("g=9,0/9,4",))
    one, other = fleet_of(
        fleet_of_words(("leo:a,x=-2,y=3", "rover_zero4wd:b,x=3,y=0,driver=spin"), shared)
    )
    batches = together((one, other))
    next(batches)
    there = one.simulation.position
    other.reset(Place(*there[:2], 1.0))
    apart = LEO.reach + find_rover("rover_zero4wd").reach + GAP  # to the left of the heading
    left = there[0] - apart * math.sin(1.0), there[1] + apart * math.cos(1.0), 1.0
    assert (*other.simulation.position[:2], other.simulation.yaw) == pytest.approx(left, abs=0.02)
    assert one.simulation.position == there
    other.reset()
    assert other.simulation.position[:2] == pytest.approx((3.0, 0.0), abs=0.02)
    for pair in batches:
        for batch in pair:
            samples = [sample for tick in batch.ticks for sample in tick.samples]
            assert not any(s.hazard_contact for s in samples if isinstance(s, TruthState))
            people = [s for s in samples if isinstance(s, ActorPoses)]
            assert all(s.position[0][1] == pytest.approx(s.stamp_ns / 1e9, abs=0.02) for s in people)
