"""Drivers that meet hazards on purpose: their plans in closed form, their scripts on an ideal rover."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.drivers import find_driver
from harness.drivers.base import DriverContext, Observation
from harness.drivers.encounters import StagedEncounter
from harness.episode.episode import Episode
from harness.robots import ROVERS, RoverSpec
from harness.samples import Truth, Twist
from harness.spec.run import Run
from harness.world.obstacles import Obstacle, ObstacleKind, orientation
from tests.support.rovers import LEO

if TYPE_CHECKING:
    from tests.harness.drivers.conftest import IdealRover

MEETING = ("ram", "reverse_into", "graze", "swing", "pass_by")
TOP_SPEED = {
    "leo": 12.0 * 0.0625,
    "rover_zero4wd": 10.0 * 0.127,
    "husky": 6.1 * 0.1651,
    "jackal": 20.5 * 0.098,
}
RADIUS = 0.3  # of a post [m]
START = 6.0 - RADIUS - LEO.length / 2 - 1.2  # of the straight line to a post at x = 6 m

MakeDice = Callable[..., np.random.Generator]


@pytest.mark.parametrize(
    ("driver", "robot"), [*((driver, "rover_zero4wd") for driver in MEETING), ("pass_by", "leo")]
)
def test_it_meets_hazards_as_its_name_says_without_tipping_over(driver: str, robot: str) -> None:
    run = Run.of(
        terrain="posts", robot=robot, driver=driver, seed=3, duration=16.0, lidar_beams=2, timestep=0.005
    )
    truth = Truth()
    for batch in Episode(run).batches():
        truth = batch.truth
    assert truth.path_length > 2.0
    assert not truth.tipped_over
    assert truth.hazard_contact_s < 5.0
    assert (truth.hazard_contacts >= 1) is (driver != "pass_by")


def block(half_size: tuple[float, float], yaw: float) -> Obstacle:
    return Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(*half_size, 1.0),
        position=(1.0, 2.0, 0.0),
        quaternion=orientation(yaw),
    )


def post(x: float, y: float, kind: ObstacleKind = ObstacleKind.HAZARD) -> Obstacle:
    return Obstacle(kind=kind, shape="cylinder", half_size=(RADIUS, 1.0), position=(x, y, 0.5))


def made(
    driver: str,
    rng: np.random.Generator,
    *obstacles: Obstacle,
    rover: RoverSpec = LEO,
    middle: tuple[float, float] = (0.0, 0.0),
) -> StagedEncounter:
    obstacles = obstacles or (post(5.0, 0.0),)
    context = DriverContext(rover, (20.0, 20.0), np.zeros(2), rng, obstacles, middle=middle)
    encounter = find_driver(driver)(context)
    assert isinstance(encounter, StagedEncounter)
    return encounter


@pytest.mark.parametrize("middle", [(0.0, 0.0), (100.0, -50.0)])
@pytest.mark.parametrize("driver", MEETING)
def test_without_a_hazard_on_the_inner_map_it_is_refused(
    driver: str, middle: tuple[float, float]
) -> None:
    rng, (x, y) = np.random.default_rng(0), middle
    rock = post(x + 5.0, y, ObstacleKind.ROCK)
    for obstacles in ((rock,), (post(x + 18.01, y), post(x, y - 18.01), rock)):
        said = r"hazards.*, and none stands 2 m .*; terrains with hazards: rocky, posts, maze$"
        with pytest.raises(UsageError, match=said):
            made(driver, rng, *obstacles, middle=middle)
    within = made(driver, rng, post(x + 17.9, y - 17.9), middle=middle)
    assert within.command(Observation(0, x, y, 0.0, None)) != Twist()


# Draws: heading, offset, speed; past it: heading, side, gap, speed. Widths: of block + half the rover.
PLANS = [
    ("ram", (1.0, 1.0, 0.0), 0.5, 0.6, 0.0, 0.25),
    ("ram", (-2.0, 0.0, 1.0), -1.0, -0.6, 0.0, 0.9),
    ("reverse_into", (0.0, 0.5, 1.0), 0.0, 0.0, 0.0, -0.9),
    ("pass_by", (1.0, 1.0, 0.0, 0.0), 0.5, 1.0, 0.04, 0.25),
    ("pass_by", (0.0, 0.0, 1.0, 1.0), 0.0, -1.0, -0.5, 0.9),
    ("graze", (0.0, 1.0, 0.0, 1.0), 0.0, 1.0, -0.08, 0.9),
    ("graze", (0.0, 0.0, 1.0, 1.0), 0.0, -1.0, 0.0, 0.9),
    ("swing", (0.0, 1.0, 0.0, 1.0), 0.0, 1.0, 0.0, 0.9),
    ("swing", (0.0, 0.0, 1.0, 1.0), 0.0, -1.0, -0.1, 0.9),
]


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize(("driver", "shares", "veer", "widths", "gap", "speed"), PLANS)
def test_a_plan_says_from_where_how_far_beside_and_how_fast(
    driver: str,
    shares: tuple[float, ...],
    veer: float,
    widths: float,
    gap: float,
    speed: float,
    rover: RoverSpec,
    dice: MakeDice,
) -> None:
    """A long block that lies along the line, so that its length and its width tell themselves apart."""
    bearing = 0.7
    y_min, y_max = rover.footprint[2:]
    meeting = made(driver, dice(*shares), rover=rover).plan(block((0.8, 0.1), bearing + veer), bearing)
    assert meeting.course == pytest.approx(bearing + veer)
    aside = widths * (0.1 + (y_max - y_min) / 2) + gap
    assert (meeting.along((1.0, 2.0)), meeting.aside((1.0, 2.0))) == pytest.approx((0.0, -aside))
    assert meeting.reach == pytest.approx(0.8)
    assert meeting.speed == pytest.approx(speed * TOP_SPEED[rover.name])
    turned = math.pi if speed < 0 else 0.0
    assert math.remainder(meeting.heading - bearing - veer - turned, math.tau) == pytest.approx(0.0)


@pytest.mark.parametrize("aside", [0.0, 0.2, -0.2])
@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize(("driver", "sign"), [("ram", 1.0), ("reverse_into", -1.0)])
def test_it_drives_up_lines_up_goes_to_60_cm_past_the_hazard_and_leaves(
    driver: str, sign: float, rover: RoverSpec, aside: float, dice: MakeDice, ideal: "type[IdealRover]"
) -> None:
    """Along x, through a post that only the driver knows of; beside the line it steers back to it."""
    x = 6.0
    start = x - RADIUS - rover.length / 2 - 1.2
    veer = -math.atan2(-aside, x) / 0.5
    shares = (0.0, veer, 0.5, 1.0, 0.0)  # hazard, heading, offset, speed, patience
    run = ideal(made(driver, dice(*shares), post(x, 0.0), rover=rover), y=aside)
    twists = list(run.steps(900))
    speed = sign * 0.9 * TOP_SPEED[rover.name]
    acting = next(n for n, t in enumerate(twists) if t.linear == pytest.approx(speed))
    there = run.path[acting]
    assert math.dist(there[:2], (start, 0.0)) < 0.25 + rover.cruise_speed * 0.05
    assert abs(math.remainder(there[2] - (math.pi if sign < 0 else 0.0), math.tau)) < 0.06
    assert max(abs(t.angular) for t in twists[:acting]) <= rover.cruise_yaw_rate
    passed = next(n for n, p in enumerate(run.path) if n > acting and p[0] >= x + RADIUS + 0.6)
    assert [t.linear for t in twists[acting:passed]] == pytest.approx([speed] * (passed - acting))
    assert abs(run.path[passed][1]) < max(0.02, 0.25 * abs(there[1]))
    leaving = twists[passed : passed + 30]
    assert leaving == [Twist(-0.5 * sign * rover.cruise_speed)] * 30
    assert twists[passed + 30] != leaving[0]


@pytest.mark.parametrize(("share", "seconds"), [(0.0, 0.05), (0.5, 0.225), (0.93, 0.3755)])
def test_it_pushes_for_5_to_40_hundredths_of_a_second_and_then_backs_off(
    share: float, seconds: float, dice: MakeDice, ideal: "type[IdealRover]"
) -> None:
    shares = (0.0, 0.0, 0.5, 0.0, share)  # hazard, heading, offset, speed, patience
    run = ideal(made("ram", dice(*shares), post(4.0, 0.0)), touches=lambda rover: rover.x > 3.5)
    twists = list(run.steps(800))
    first = next(n for n, p in enumerate(run.path) if p[0] > 3.5)
    pushed = next(n for n in range(first, 800) if twists[n].linear < 0.0) - first
    assert pushed + 1 == math.ceil(round(seconds / 0.05, 9)), "the first it feels counts"
    assert {t.linear for t in twists[first - 1 : first + pushed]} == {0.25 * TOP_SPEED["leo"]}
    assert twists[first + pushed] == Twist(-0.2)


@pytest.mark.parametrize("touched", [0, 10])
def test_swinging_round_stops_beside_the_hazard_and_turns_3_s_each_way_or_until_it_touches(
    touched: int, dice: MakeDice, ideal: "type[IdealRover]"
) -> None:
    """With `touched`, it touches something for two periods after so many of the first turn."""
    shares = (0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0)  # hazard, heading, left, gap 0.1 m, speed, patience
    turning = list[int]()

    def touches(rover: "IdealRover") -> bool:
        if rover.x > 5.9 and rover.linear == 0.0:
            turning.append(rover.period)
        return bool(touched) and touched <= len(turning) < touched + 2

    run = ideal(made("swing", dice(*shares), post(6.0, 0.0)), touches=touches)
    twists = list(run.steps(1200))
    begin, periods = turning[0] - 1, touched or 60
    assert 6.0 <= run.path[begin][0] < 6.0 + 0.9 * TOP_SPEED["leo"] * 0.05
    assert run.path[begin][1] == pytest.approx(RADIUS + 0.214 + 0.1, abs=0.03)
    assert twists[begin : begin + periods] == [Twist(0.0, 1.0)] * periods
    back = begin + periods + (0 if touched else 60)
    assert twists[begin + periods : back] == [Twist(0.0, -1.0)] * (back - begin - periods)
    assert twists[back : back + 30] == [Twist(-0.2)] * 30


def stuck(x: float, yaw: float, count: int, dice: MakeDice, hazard: float = 6.0) -> list[Twist]:
    """The commands to a rover that does not get on."""
    encounter = made("ram", dice(0.0, 0.0, 0.5, 0.0, 0.0), post(hazard, 0.0))
    return [encounter.command(Observation(0, x, 0.0, yaw, None)) for _ in range(count)]


def test_who_does_not_get_to_the_line_gives_up_after_20_s_or_at_a_touch(
    dice: MakeDice, ideal: "type[IdealRover]"
) -> None:
    ahead, back = Twist(LEO.cruise_speed), Twist(-0.2)
    assert stuck(0.0, 0.0, 430, dice, 16.0) == [ahead] * 400 + [back] * 30
    touching = ideal(
        made("ram", dice(0.0, 0.0, 0.5), post(6.0, 0.0)), touches=lambda rover: rover.x > 1.0
    )
    twists = list(touching.steps(100))
    touched = next(n for n, p in enumerate(touching.path) if p[0] > 1.0)
    assert twists[: touched + 30] == [ahead] * touched + [back] * 30


def test_it_lines_up_within_60_mrad_or_gives_up_after_6_s(dice: MakeDice) -> None:
    for yaw, turns in ((0.059, False), (-0.059, False), (0.061, True), (-0.061, True)):
        (twist,) = stuck(START, yaw, 1, dice)
        assert (twist.linear == 0.0) == turns
        assert twist.angular == pytest.approx(-2.5 * yaw)
    twists = stuck(START, 2.0, 121, dice)
    assert twists[:120] == [Twist(0.0, -1.0)] * 120
    assert twists[120].linear == pytest.approx(0.25 * TOP_SPEED["leo"])


@pytest.mark.parametrize(("share", "chosen"), [(0.0, 4), (0.3, 1), (0.6, 3), (0.99, 0)])
def test_it_chooses_among_the_four_nearest(share: float, chosen: int, dice: MakeDice) -> None:
    """By the direction into which it sets off: the posts stand around it, as far as these numbers."""
    distances = (9.0, 5.0, 11.0, 7.0, 3.0)
    posts = [
        post(d * math.cos(0.3 * (n - 2)), d * math.sin(0.3 * (n - 2))) for n, d in enumerate(distances)
    ]
    plain = made("ram", dice(share, 0.0, 0.5, 0.5), *posts)
    twist = plain.command(Observation(0, 0.0, 0.0, 0.3 * (chosen - 2) - 0.1, None))
    assert twist.angular == pytest.approx(0.25)


def test_it_never_meets_the_same_hazard_twice_running_if_there_is_another(
    dice: MakeDice, ideal: "type[IdealRover]"
) -> None:
    shares = (0.0, 0.0, 0.5, 1.0, 0.0)
    pair = ideal(made("ram", dice(*shares, *shares), post(4, 0), post(-3, 0)))
    list(pair.steps(900))
    assert min(x for x, _, _ in pair.path) < -3.0
