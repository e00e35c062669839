"""Missions: routes driven and counted, across resets, aborts and losses of the link."""

import math
from pathlib import Path

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers.policy import BESIDE_LIDAR, Policy, write_policy
from harness.episode.assembly import check, fleet, graded_world, route_progress, world_of
from harness.episode.batch import Batch
from harness.episode.episode import Episode
from harness.episode.topics import outlets_of
from harness.robots import ROVERS
from harness.robots.model import tip_limit
from harness.samples import GoalPose
from harness.spec.fleet import parse_rovers
from harness.spec.run import Run
from harness.world.grading import Limits, graded
from harness.world.route import Mark, RouteProgress, crossed


def driven(**changes: object) -> list[Batch]:
    light: dict[str, object] = {"terrain": "flat", "driver": "goal", "duration": 12.0, "lidar_beams": 64}
    return list(Episode(Run.of(**light | changes)).batches())


def reached(batches: list[Batch], run: Run) -> RouteProgress:
    progress = route_progress(run)
    for batch in batches:
        progress.observe(batch.truth.time_ns / 1e9, batch.truth.position[:2])
    return progress


def test_a_route_leads_through_a_gate_to_a_target_and_ends_before_it() -> None:
    given: dict[str, object] = {"targets": ("gate:x=3,y=0.5", "aruco:x=6,y=1.5"), "datum": "0,0,0"}
    east = math.degrees(1.5 / 6378137.0)  # by the equator's radius
    given["route"] = f"@0,{east:.12f}/gate/aruco:radius=1"
    batches = driven(**given, duration=20.0)
    progress = reached(batches, Run.of(terrain="flat", **given))
    begun, (last,) = next((b.truth.position[:2], b.goals) for b in reversed(batches) if b.goals)
    assert math.dist(begun, (last.x, last.y)) == pytest.approx(
        math.dist(begun, (6.0, 1.5)) - 0.7, abs=0.05
    )
    assert list(progress.reached) == [0, 1, 2]
    assert progress.done_s < 20.0
    assert 0.3 < math.dist(batches[-1].truth.position[:2], (6.0, 1.5)) < 1.0
    assert batches[-1].truth.hazard_contacts == 0


def test_who_came_round_a_gate_is_sent_back_through_it() -> None:
    given: dict[str, object] = {"targets": ("gate:x=0,y=2,yaw=1.5707963",), "route": "3,1.5/gate"}
    batches = driven(**given, duration=40.0)
    assert list(reached(batches, Run.of(terrain="flat", **given)).reached) == [0, 1]
    assert len([goal for batch in batches for goal in batch.goals]) == 3  # the gate's twice


def towards_goals(file: Path) -> str:
    """Writes the policy that turns by the sine of the bearing and drives by its cosine."""
    weights = np.zeros((64 + BESIDE_LIDAR, 2), np.float32)
    weights[1], weights[2] = (0.0, 1.0), (0.5, 0.0)
    write_policy(file, Policy(((weights, np.zeros(2, np.float32)),)))
    return f"policy:{file}"


def test_drivers_come_as_near_as_a_route_or_an_area_wants(tmp_path: Path) -> None:
    policy = towards_goals(tmp_path / "towards.npz")
    for driver, route in (("goal", "post:radius=0.5"), (policy, "post"), (policy, "2,0:radius=0.3")):
        given: dict[str, object] = {"targets": ("post:x=4,y=0.3",), "route": route}
        batches = driven(**given, driver=driver)
        assert list(reached(batches, Run.of(terrain="flat", **given)).reached) == [0], (driver, route)
    batches = driven(driver=policy, goal_area=(-3.0, 3.0, -3.0, 3.0), duration=15.0)
    assert sum(len(batch.goals) for batch in batches) > 3


def test_a_reset_gives_the_way_point_in_hand_again() -> None:
    batches = driven(route="2,0/0,2", resets=[8.0], duration=15.0)
    goals = [(batch.truth.time_ns / 1e9, goal.x) for batch in batches for goal in batch.goals]
    progress = reached(batches, Run.of(terrain="flat", route="2,0/0,2"))
    assert [x for _, x in goals].count(0.0) == 2
    assert list(progress.reached) == [0, 1]


def test_a_reset_gives_the_goal_of_an_area_again() -> None:
    batches = driven(goal_area=(2.0, 3.0, 2.0, 3.0), resets=[2.0], duration=4.0)
    first, second = (goal for batch in batches for goal in batch.goals)
    assert first == second
    assert batches[-1].truth.path_length - batches[41].truth.path_length > 0.2


def test_a_reset_ends_neither_an_abort_nor_the_loss_of_the_link() -> None:
    commands, link = [(0.2, 0.5, 0.0), (2.5, 0.5, 0.0)], [(1.0, 2.5)]
    plans: tuple[dict[str, object], ...] = (
        {"route": "9,0", "aborts": [1.0]},
        {"driver": "cmd_vel", "commands": commands, "link_losses": link},
    )
    for plan in plans:
        path = [batch.truth.path_length for batch in driven(**plan, resets=[2.0], duration=3.5)]
        assert path[20] > 0.1
        assert path[-1] - path[41] < 0.02


def test_a_rover_stands_from_an_abort_until_it_resumes() -> None:
    batches = driven(route="9,0", aborts=[2.0], resumes=[5.0], duration=8.0)
    path = [batch.truth.path_length for batch in batches]
    assert [n for n, batch in enumerate(batches) if batch.goals] == [0, 100]  # it is told again
    assert path[99] - path[59] < 0.02  # from 3 s to 5 s
    assert path[-1] - path[109] > 0.3


@pytest.mark.parametrize(("timeout", "goes_on"), [(None, True), (0.5, False)])
def test_no_command_arrives_while_the_link_is_lost(timeout: float | None, goes_on: bool) -> None:
    commands = [(0.0, 0.3, 0.0), (2.0, 0.0, 0.0)]
    batches = driven(
        driver="cmd_vel",
        commands=commands,
        link_losses=[(1.5, 2.0)],
        cmd_vel_timeout=timeout,
        duration=4.0,
    )
    moved = batches[-1].truth.path_length - batches[40].truth.path_length
    assert (moved > 0.4) == goes_on


def test_who_commands_the_rover_is_told_each_way_point_once() -> None:
    batches = driven(driver="cmd_vel", route="1.5,0/9,0", commands=[(0.0, 0.3, 0.0)], duration=6.0)
    told = [s for b in batches for t in b.ticks for s in t.samples if isinstance(s, GoalPose)]
    assert [goal.position[0] for goal in told] == [1.5, 9.0]
    assert told[0].stamp_ns == 10_000_000
    run = Run.of(terrain="flat", route="1,0")
    rovers = fleet(run, parse_rovers(["leo:a,driver=wander", "leo:b,driver=cmd_vel"], run.rover))
    published = [GoalPose in outlets_of(rovers, number, lambda _: None) for number in (0, 1)]
    assert published == [False, True]


@pytest.mark.parametrize(("at", "hits"), [((1.0, 0.5), True), ((1.0, 2.0), False), ((-1.0, 0.5), False)])
def test_a_gate_is_passed_between_its_posts_either_way(at: tuple[float, float], hits: bool) -> None:
    left, right = (0.0, 1.0), (0.0, -1.0)
    assert crossed((-1.0, 0.0), at, left, right) is hits
    assert crossed(at, (-1.0, 0.0), left, right) is hits


@pytest.mark.parametrize("seed", range(5))
def test_any_order_reaches_what_the_given_one_does_not(seed: int) -> None:
    """A walk through all way points backwards: in their order only the last step counts."""
    places = [tuple(p) for p in np.random.default_rng(seed).uniform(-50.0, 50.0, (4, 2)).tolist()]
    marks = tuple(Mark((x, y), 0.5) for x, y in places)
    given, any_order = RouteProgress(marks), RouteProgress(marks, any_order=True)
    for second, mark in enumerate(reversed(marks)):
        given.observe(second, mark.place)
        any_order.observe(second, mark.place)
    assert list(given.reached) == [0]
    assert list(any_order.reached) == [3, 2, 1, 0]
    assert any_order.done_s == 3.0
    assert math.isnan(given.done_s)


def test_a_way_point_that_takes_too_long_is_missed_and_the_next_one_is_next() -> None:
    far = (Mark((x, 0.0), 0.5, within=2.0) for x in (5.0, 9.0))
    progress, next_ones = RouteProgress((*far, Mark((0.0, 0.0), 0.5)), limit=9.0), list[int | None]()
    for second in range(8):
        progress.observe(second, (0.0, 0.0))
        next_ones.append(progress.current)
    assert next_ones == [0, 0, 0, 1, 1, 1, 2, None]  # each has its own time
    assert list(progress.reached) == [2]
    assert math.isnan(progress.done_s)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"route": "3,4/tree"}, "no targets"),
        ({"route": "3,4/tree", "targets": ["post"]}, "available: post"),
        ({"route": "3;4"}, "X,Y"),
        ({"route": "3,4:radius=2/5,6"}, "behind the last way point"),
        ({"route": "3,4:speed=2"}, "radius"),
        ({"route": [{"at": [1, 2], "target": "a"}]}, "one place"),
        ({"route": []}, "at least 1"),
        ({"route": "3,4", "driver": "wander"}, "follows no route"),
        ({"route": "3,4", "goals": [(0.0, 1.0, 1.0, 0.0)]}, "leave out goals"),
        ({"route": "3,4", "link_losses": [(99.0, 1.0)]}, "not in the run"),
    ],
)
def test_a_wrong_route_is_told_in_one_line(given: dict[str, object], words: str) -> None:
    with pytest.raises(UsageError) as told:
        check(Run.of(**{"driver": "goal"} | given))
    assert words in str(told.value)
    assert "\n" not in str(told.value)


def test_a_route_of_any_order_goes_to_the_nearest_and_ends_with_its_limit() -> None:
    progress = route_progress(Run.of(terrain="flat", driver="goal", route="5,0/2,0:order=any,limit=3"))
    progress.observe(0.0, (0.0, 0.0))
    assert progress.current == 1
    progress.observe(3.1, (2.0, 0.0))
    assert list(progress.reached) == []
    assert progress.current is None


def test_a_world_is_graded_by_what_that_rover_of_the_run_can() -> None:
    run, husky = Run.of(terrain="gravel"), ROVERS["husky"]
    run = fleet(run, parse_rovers(["leo:a", "husky:b"], run.rover))
    limits = Limits(husky.slope_limit, husky.step_limit, tip_limit(husky), husky.length)
    expected = graded(world_of(run), limits).layers["danger"]
    assert np.array_equal(graded_world(run, 1).layers["danger"], expected, equal_nan=True)
