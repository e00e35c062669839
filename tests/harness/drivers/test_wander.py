"""Wander against its rule worked out heading by heading, with goals that the test chooses."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from harness.drivers.base import DriverContext, Observation
from harness.drivers.wander import Roam, Wander
from harness.robots import ROVERS, RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO, ROVER_ZERO4WD

BEARINGS = np.linspace(-math.pi, math.pi, 91)[:-1] + 0.01
AHEAD = 0.5  # the share of -pi..pi that is straight along x
OPEN = np.full(len(BEARINGS), np.inf)

MakeDice = Callable[..., np.random.Generator]


def wander(rng: np.random.Generator, rover: RoverSpec = LEO, bearings: np.ndarray = BEARINGS) -> Wander:
    return Wander(DriverContext(rover, (20.0, 15.0), bearings, rng))


def seen(
    seconds: float = 0.0,
    x: float = 0.0,
    y: float = 0.0,
    yaw: float = 0.0,
    ranges: np.ndarray | None = OPEN,
) -> Observation:
    scan = None if ranges is None else ranges.astype(np.float32)
    return Observation(round(seconds * 1e9), x, y, yaw, scan)


def off(angle: float) -> float:
    return abs(math.remainder(angle, math.tau))


def free_range(heading: float, ranges: np.ndarray, rover: RoverSpec) -> float:
    """To the nearest return ahead that lies within half the track and 12 cm of the way; 3 m at most."""
    reach = math.inf
    for distance, bearing in zip(np.where(np.isnan(ranges), np.inf, ranges), BEARINGS, strict=True):
        near = max(float(np.float32(distance)), 0.0)
        aside = near * math.sin(off(bearing - heading)) if near < 3.0 else math.inf
        if off(bearing - heading) < math.pi / 2 and aside < rover.track / 2 + 0.12:
            reach = min(reach, near)
    return reach


def numbers(twist: Twist) -> Any:  # noqa: ANN401 - pytest's approx
    return pytest.approx([twist.linear, twist.angular], abs=1e-9)


def rule(goal: float, ranges: np.ndarray, rover: RoverSpec) -> Twist:
    """The command for a goal in that direction."""
    headings = [math.radians(7.5 * n - 180.0) for n in range(48)]
    free = [free_range(heading, ranges, rover) for heading in headings]
    cost = [off(h - goal) - 1.5 * min(f, 3.0) for h, f in zip(headings, free, strict=True)]
    best = headings[cost.index(min(cost))]
    ahead = free[24]
    if ahead < 0.45:
        return Twist(0.0, math.copysign(rover.cruise_yaw_rate, best))
    slower = min(1.0, ahead / 1.2) * max(0.0, math.cos(best))
    return Twist(rover.cruise_speed * slower, max(-1.0, min(1.0, 1.5 * best)) * rover.cruise_yaw_rate)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
@pytest.mark.parametrize("seed", range(30))
def test_it_takes_the_way_that_is_free_and_near_the_goals_direction(
    rover: RoverSpec, seed: int, dice: MakeDice
) -> None:
    rng = np.random.default_rng(seed)
    ranges = rng.uniform(0.0, 4.0, len(BEARINGS)) + rng.choice([0.0, 0.3, 1.0, 2.5])
    ranges[rng.random(len(BEARINGS)) < rng.choice([0.3, 0.9, 0.97])] = np.inf
    for odd in (np.nan, -np.inf):  # -inf is nearer than the lidar can see
        ranges[rng.random(len(BEARINGS)) < rng.choice([0.003, 0.03])] = odd
    share = rng.random()
    driver, yaw = wander(dice(0.0, share), rover), rng.uniform(-math.pi, math.pi)
    goal = math.remainder((2 * share - 1) * math.pi - yaw, math.tau)
    twist = driver.command(seen(yaw=yaw, ranges=ranges))
    assert [twist.linear, twist.angular] == numbers(rule(goal, ranges, rover))
    unseeing = wander(dice(0.0, share), rover).command(seen(yaw=yaw, ranges=None))
    assert [unseeing.linear, unseeing.angular] == numbers(rule(goal, OPEN, rover))


def bearing_driven(driver: Wander, observation: Observation) -> float:
    """The direction in the world that it turns to, from the yaw rate where that is not at its limit."""
    return observation.yaw + driver.command(observation).angular / (1.5 * LEO.cruise_yaw_rate)


@pytest.mark.parametrize(
    ("share", "start", "goal"),
    [
        (0.0, (0.0, 0.0), (4.0, 0.0)),
        (1.0, (0.0, 0.0), (10.0, 0.0)),
        (1.0, (12.0, 0.0), (17.0, 0.0)),  # 3 m from the edge
    ],
)
def test_a_goal_lies_4_to_10_m_away_on_the_map_and_holds_until_60_cm_before_it(
    share: float, start: tuple[float, float], goal: tuple[float, float], dice: MakeDice
) -> None:
    """Driven past at a distance, its direction tells where it is."""
    rng = dice(share, AHEAD, 0.0, 0.0)
    driver = wander(rng)
    driver.command(seen(0.0, *start))
    for seconds, aside in ((1.0, 1.5), (2.0, -1.5), (3.0, 0.65), (4.0, -0.65)):
        yaw = math.atan2(-aside, 1e-9)
        assert bearing_driven(driver, seen(seconds, goal[0], aside, yaw)) == pytest.approx(
            yaw, abs=0.066
        )
    assert rng.draws == 2  # type: ignore[attr-defined]  # Dice counts
    driver.command(seen(5.0, goal[0] - 0.59, 0.0))
    assert rng.draws == 4  # type: ignore[attr-defined]


def test_a_goal_that_is_not_reached_in_45_seconds_is_given_up(dice: MakeDice) -> None:
    rng = dice(0.0, AHEAD)
    driver = wander(rng)
    for seconds in range(1, 47):
        driver.command(seen(float(seconds), x=-0.3 * (seconds % 2)))
    assert rng.draws == 2  # type: ignore[attr-defined]
    driver.command(seen(46.05))
    assert rng.draws == 4  # type: ignore[attr-defined]
    for seconds in range(47, 92):
        driver.command(seen(float(seconds), x=-0.3 * (seconds % 2)))
    assert rng.draws == 4, "patience begins with the goal"  # type: ignore[attr-defined]


@pytest.mark.parametrize("place", [(18.01, 1.0), (-18.01, -1.0), (1.0, 13.01), (-1.0, -13.01)])
def test_within_2_m_of_the_edge_it_heads_for_the_middle(
    place: tuple[float, float], dice: MakeDice
) -> None:
    x, y = place
    back = math.atan2(-y, -x)
    across = back + math.pi / 2
    driver = wander(dice(0.0, (math.remainder(across, math.tau) / math.pi + 1) / 2))
    inside = seen(0.0, 0.99 * x, 0.99 * y, across)
    assert abs(driver.command(inside).angular) < 0.5  # a right angle to the middle's direction
    assert bearing_driven(driver, seen(0.05, x, y, back)) == pytest.approx(back, abs=0.066)


@pytest.mark.parametrize(("share", "turn"), [(0.49, 0.5), (0.51, -0.5)])
def test_after_3_s_without_25_cm_of_progress_it_backs_out_for_2_s_to_either_side(
    share: float, turn: float, dice: MakeDice
) -> None:
    rng = dice(0.0, AHEAD, share, 0.0, AHEAD)
    driver = wander(rng, ROVER_ZERO4WD)
    commands = [driver.command(seen(0.05 * n, x=0.24 * (n > 0))) for n in range(61 + 40 + 61 + 1)]
    backwards = Twist(-0.6 * 0.5, turn * 2.0)
    expected = [False] * 61 + [True] * 40 + [False] * 61 + [True]
    assert [command == backwards for command in commands[:-1]] == expected[:-1]
    assert commands[-1].linear == pytest.approx(-0.3)
    assert [command.linear < 0 for command in commands] == expected
    assert rng.draws == 6, "a new goal after backing out"  # type: ignore[attr-defined]
    creeps = wander(dice(1.0, AHEAD))
    assert all(creeps.command(seen(0.05 * n, 0.26 * (n // 59))).linear >= 0.0 for n in range(300))


@pytest.mark.parametrize("driver", [Wander, Roam])
def test_where_the_map_lies_in_the_world_changes_nothing(driver: type[Wander]) -> None:
    """Two maps, one moved by 256 m and -512 m, so that no bit is lost: equal commands, at edges too."""
    at_origin, moved = (
        driver(DriverContext(LEO, (20.0, 15.0), BEARINGS, np.random.default_rng(5), middle=middle))
        for middle in ((0.0, 0.0), (256.0, -512.0))
    )
    for index in range(400):
        x, y = 19.0 * math.sin(0.05 * index), 14.0 * math.sin(0.031 * index)
        here, there = seen(0.5 * index, x, y), seen(0.5 * index, x + 256.0, y - 512.0)
        one, other = at_origin.command(here), moved.command(there)
        assert (one.linear, one.angular) == pytest.approx((other.linear, other.angular), abs=1e-6)
