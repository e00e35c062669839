"""Drivers that meet hazards on purpose: their plans in closed form, their scripts on an ideal rover."""

import cmath
import math
from collections.abc import Callable
from itertools import groupby
from typing import TYPE_CHECKING

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.base.errors import UsageError
from harness.drivers import find_driver
from harness.drivers.base import DriverContext, Observation
from harness.drivers.staged import Meeting, StagedEncounter
from harness.episode.episode import Episode
from harness.robots import ROVERS, RoverSpec
from harness.samples import Twist
from harness.spec.run import Run
from harness.truth.traversal import Truth
from harness.world.obstacles import Obstacle, ObstacleKind, half_extent, orientation
from tests.support.rovers import LEO, ROVER_ZERO4WD

if TYPE_CHECKING:
    from tests.harness.drivers.conftest import Ride

MEETING = ("ram", "reverse_into", "graze", "swing", "pass_by")
TOP_SPEED = {"leo": 12.0 * 0.0625, "rover_zero4wd": 10.0 * 0.127}
RADIUS = 0.3  # of a post [m]

MakeDice = Callable[..., np.random.Generator]


def driven(driver: str, *, robot: str = "rover_zero4wd", seed: int = 3, duration: float = 16.0) -> Truth:
    config = Run.of(
        terrain="posts",
        robot=robot,
        driver=driver,
        seed=seed,
        duration=duration,
        lidar_beams=2,
        timestep=0.005,
    )
    truth = Truth()
    for batch in Episode(config).batches():
        truth = batch.truth
    return truth


@pytest.mark.parametrize("driver", ["ram", "reverse_into", "graze", "swing"])
def test_it_touches_hazards_without_tipping_over(driver: str) -> None:
    truth = driven(driver)

    assert truth.hazard_contacts >= 1
    assert truth.hazard_contact_s < 5.0
    assert not truth.tipped_over


@pytest.mark.parametrize("robot", ["leo", "rover_zero4wd"])
def test_passing_by_comes_near_and_touches_nothing(robot: str) -> None:
    truth = driven("pass_by", robot=robot)

    assert truth.hazard_contacts == 0
    assert truth.path_length > 3.0


def block(half_size: tuple[float, float], yaw: float) -> Obstacle:
    return Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(*half_size, 1.0),
        position=(1.0, 2.0, 0.0),
        quaternion=orientation(yaw),
    )


@pytest.mark.parametrize(
    ("yaw", "direction", "extent"),
    [(0.0, 0.0, 0.3), (0.0, math.pi / 2, 0.1), (math.pi / 2, 0.0, 0.1), (0.3, 0.3, 0.3)],
)
def test_half_extent_of_a_turned_block(yaw: float, direction: float, extent: float) -> None:
    assert half_extent(block((0.3, 0.1), yaw), direction) == pytest.approx(extent)


def post(x: float, y: float, kind: ObstacleKind = ObstacleKind.HAZARD) -> Obstacle:
    return Obstacle(kind=kind, shape="cylinder", half_size=(RADIUS, 1.0), position=(x, y, 0.5))


def made(
    driver: str, rng: np.random.Generator, *obstacles: Obstacle, rover: RoverSpec = LEO
) -> StagedEncounter:
    context = DriverContext(rover, (20.0, 20.0), np.zeros(2), rng, obstacles or (post(5.0, 0.0),))
    encounter = find_driver(driver)(context)
    assert isinstance(encounter, StagedEncounter)
    return encounter


@pytest.mark.parametrize("driver", MEETING)
def test_without_a_hazard_on_the_inner_map_it_is_refused(driver: str) -> None:
    outside = post(18.01, 0.0), post(0.0, -18.01), post(5.0, 0.0, ObstacleKind.ROCK)
    for obstacles in (outside[2:], outside):
        with pytest.raises(
            UsageError,
            match=r"hazards.*, and none stands 2 m .*; terrains with hazards: rocky, posts, maze$",
        ):
            made(driver, np.random.default_rng(0), *obstacles)
    within = made(driver, np.random.default_rng(0), post(17.9, -17.9))
    assert within.command(Observation(0, 0.0, 0.0, 0.0, None)) != Twist()


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


METRES, ANGLES = st.floats(-50.0, 50.0), st.floats(-10.0, 10.0)


@given(x=METRES, y=METRES, course=ANGLES, ahead=METRES, left=METRES)
def test_a_meeting_tells_how_far_ahead_and_how_far_to_its_left_a_point_lies(
    x: float, y: float, course: float, ahead: float, left: float
) -> None:
    """By complex numbers."""
    meeting, direction = Meeting((x, y), course, 0.3, 1.0), cmath.rect(1.0, course)
    point = complex(x, y) + complex(ahead, left) * direction
    there = point.real, point.imag
    assert (meeting.along(there), meeting.aside(there)) == pytest.approx((ahead, left), abs=1e-9)
    reached = complex(x, y) + ahead * direction
    assert meeting.at(ahead) == pytest.approx((reached.real, reached.imag), abs=1e-9)


def phases(twists: list[Twist]) -> list[tuple[str, int]]:
    """What it did for how many periods: drive ahead or back, turn, stand."""
    kinds = [
        "ahead" if t.linear > 1e-9 else "back" if t.linear < 0 else "turn" if t.angular else "stand"
        for t in twists
    ]
    return [(kind, len(list(group))) for kind, group in groupby(kinds)]


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize(("driver", "sign"), [("ram", 1.0), ("reverse_into", -1.0)])
def test_it_drives_up_lines_up_goes_to_60_cm_past_the_hazard_and_leaves(
    driver: str, sign: float, rover: RoverSpec, dice: MakeDice, ride: "type[Ride]"
) -> None:
    """Straight along x, through a post that only the driver knows of."""
    x = 6.0
    run = ride(made(driver, dice(0.0, 0.0, 0.5, 1.0, 0.0), post(x, 0.0), rover=rover))
    twists = list(run.steps(900))
    start = x - RADIUS - rover.length / 2 - 1.2
    arrived = next(n for n, (there, _, _) in enumerate(run.path) if there > start - 0.25)
    assert all(t == Twist(rover.cruise_speed, 0.0) for t in twists[:arrived])
    speed = sign * 0.9 * TOP_SPEED[rover.name]
    acting = next(n for n, t in enumerate(twists) if t.linear == pytest.approx(speed))
    facing = twists[arrived:acting]
    assert all(t.linear == 0.0 for t in facing)
    assert bool(facing) == (sign < 0)
    assert max([abs(t.angular) for t in facing], default=rover.cruise_yaw_rate) == rover.cruise_yaw_rate
    passed = next(n for n, p in enumerate(run.path) if n > acting and p[0] >= x + RADIUS + 0.6)
    assert [t.linear for t in twists[acting:passed]] == pytest.approx([speed] * (passed - acting))
    assert max(abs(y) for _, y, _ in run.path[:passed]) < 0.06
    leaving = twists[passed : passed + 30]
    assert leaving == [Twist(-0.5 * sign * rover.cruise_speed)] * 30
    assert twists[passed + 30] != leaving[0]


@pytest.mark.parametrize(("share", "seconds"), [(0.0, 0.05), (0.5, 0.225), (0.93, 0.3755)])
def test_it_pushes_for_5_to_40_hundredths_of_a_second_and_then_backs_off(
    share: float, seconds: float, dice: MakeDice, ride: "type[Ride]"
) -> None:
    shares = (0.0, 0.0, 0.5, 0.0, share)  # hazard, heading, offset, speed, patience
    run = ride(made("ram", dice(*shares), post(4.0, 0.0)), touches=lambda rover: rover.x > 3.5)
    twists = list(run.steps(800))
    first = next(n for n, p in enumerate(run.path) if p[0] > 3.5)
    speed = twists[first - 1].linear
    assert speed > 0.0
    pushed = next(n for n in range(first, 800) if twists[n].linear < 0.0) - first
    assert pushed + 1 == math.ceil(round(seconds / 0.05, 9)), "the first it feels counts"
    assert {t.linear for t in twists[first - 1 : first + pushed]} == {speed}
    assert twists[first + pushed] == Twist(-0.2)


def test_swinging_round_stops_beside_the_hazard_and_turns_3_s_each_way(
    dice: MakeDice, ride: "type[Ride]"
) -> None:
    shares = (
        0.0,
        0.0,
        1.0,
        1.0,
        1.0,
        1.0,
        0.0,
    )  # hazard, heading, left side, gap 0.1 m, speed, patience
    run = ride(made("swing", dice(*shares), post(6.0, 0.0)))
    twists = list(run.steps(1200))
    turned = next(
        n for n in range(1200) if twists[n : n + 60] == [Twist(0.0, 1.0)] * 60 and run.path[n][0] > 5
    )
    assert 6.0 <= run.path[turned][0] < 6.0 + 0.9 * TOP_SPEED["leo"] * 0.05
    assert run.path[turned][1] == pytest.approx(RADIUS + 0.214 + 0.1, abs=0.03)
    assert twists[turned + 60 : turned + 120] == [Twist(0.0, -1.0)] * 60
    assert twists[turned + 120 : turned + 150] == [Twist(-0.2)] * 30


def test_swinging_round_ends_each_way_at_a_touch(dice: MakeDice, ride: "type[Ride]") -> None:
    shares = (0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 0.0)
    touching = range(0)
    run = ride(
        made("swing", dice(*shares), post(6.0, 0.0)), touches=lambda rover: rover.period in touching
    )
    for twist in run.steps(1200):
        if twist == Twist(0.0, 1.0) and run.x > 5.9 and not touching:
            touching = range(run.period + 10, run.period + 12)
        if touching and run.period == touching.stop + 3:
            break
    else:
        pytest.fail("it never swung round")
    assert twist == Twist(-0.2), "both ways ended"


def test_in_its_way_to_the_line_it_gives_up_at_a_touch_or_after_20_s(
    dice: MakeDice, ride: "type[Ride]"
) -> None:
    stopped = ride(made("ram", dice(0.0, 0.0, 0.5), post(6.0, 0.0)), touches=lambda rover: rover.x > 1.0)
    twists = list(stopped.steps(100))
    touched = next(n for n, p in enumerate(stopped.path) if p[0] > 1.0)
    assert phases(twists[: touched + 30]) == [("ahead", touched), ("back", 30)]
    far = made("ram", dice(0.0, 0.0, 0.5), post(16.0, 0.0))
    stuck = [far.command(Observation(0, 0.0, 0.0, 0.0, None)) for _ in range(431)]
    assert phases(stuck) == [("ahead", 400), ("back", 30), ("ahead", 1)]


@pytest.mark.parametrize(("short", "acts"), [(0.48, True), (0.52, False)])
def test_it_acts_from_where_it_got_if_that_is_half_a_metre_from_the_start_or_less(
    short: float, acts: bool, dice: MakeDice
) -> None:
    start = 6.0 - RADIUS - LEO.length / 2 - 1.2
    encounter = made("ram", dice(0.0, 0.0, 0.5, 0.0, 0.0), post(6.0, 0.0))
    here = Observation(0, start - short, 0.0, 0.0, None)
    after = [encounter.command(here) for _ in range(401)][-1]
    assert after.linear == pytest.approx(0.25 * TOP_SPEED["leo"] if acts else -0.2)


def test_it_lines_up_within_60_mrad_or_gives_up_after_6_s(dice: MakeDice) -> None:
    shares = (0.0, 0.0, 0.5, 0.0, 0.0)
    start = 6.0 - RADIUS - LEO.length / 2 - 1.2

    def stands(yaw: float) -> tuple[StagedEncounter, Observation]:
        return made("ram", dice(*shares), post(6.0, 0.0)), Observation(0, start, 0.0, yaw, None)

    for yaw, turns in ((0.059, False), (-0.059, False), (0.061, True), (-0.061, True)):
        encounter, here = stands(yaw)
        twist = encounter.command(here)
        assert (twist.linear == 0.0) == turns
        assert twist.angular == pytest.approx(-2.5 * yaw)
    encounter, here = stands(2.0)
    twists = [encounter.command(here) for _ in range(121)]
    assert twists[:120] == [Twist(0.0, -1.0)] * 120
    assert twists[120].linear == pytest.approx(0.25 * TOP_SPEED["leo"])


@pytest.mark.parametrize("speed", [0.3, -0.3])
@pytest.mark.parametrize("aside", [0.1, -0.1])
def test_beside_its_line_it_steers_back_to_where_the_line_is_half_a_metre_on(
    speed: float, aside: float, dice: MakeDice
) -> None:
    encounter, meeting = made("ram", dice(1.0)), Meeting((0.0, 0.0), 0.0, speed, 1.0)
    encounter._now = Observation(0, -1.0, aside, meeting.heading, None)
    twist = next(encounter.follow(meeting, 1.0))
    assert twist.linear == speed
    assert twist.angular == pytest.approx(-2.5 * math.atan(aside / 0.5))


def test_it_chooses_among_the_four_nearest_and_never_the_same_twice_running(
    dice: MakeDice, ride: "type[Ride]"
) -> None:
    posts = [post(distance, 0.0) for distance in (9.0, 5.0, 11.0, 7.0, 3.0)]
    encounter = made("ram", dice(0.0), *posts)
    for share, last, chosen in (
        (0.0, None, 3.0),
        (0.99, None, 9.0),
        (0.0, posts[4], 5.0),
        (0.99, posts[4], 11.0),
        (0.5, posts[0], 7.0),
    ):
        encounter.rng = dice(share)
        assert encounter._next_hazard(last).position[0] == chosen
    alone = made("ram", dice(0.0), posts[0])
    assert alone._next_hazard(posts[0]) is posts[0]
    pair = ride(
        made("ram", dice(0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 0.5, 1.0, 0.0), post(4, 0), post(-3, 0))
    )
    list(pair.steps(900))
    assert min(x for x, _, _ in pair.path) < -3.0


@pytest.mark.parametrize("rover", [LEO, ROVER_ZERO4WD])
def test_on_its_way_it_slows_down_as_it_looks_away_and_never_backs(
    rover: RoverSpec, dice: MakeDice
) -> None:
    bearing = math.atan2(1.0, 4.0)  # of the post from (2, -1)
    for error in (0.1, -0.3, 1.0, -1.5, 2.5):
        encounter = made("ram", dice(0.0, 0.0, 0.5), post(6.0, 0.0), rover=rover)
        twist = encounter.command(Observation(0, 2.0, -1.0, bearing - error, None))
        assert twist.linear == pytest.approx(rover.cruise_speed * max(0.0, math.cos(error)))
        assert twist.angular == pytest.approx(max(-1.0, min(1.0, 2.5 * error)) * rover.cruise_yaw_rate)
