"""The map of what the lidar has seen, and who drives by it: against places that are known."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.drivers import DRIVERS
from harness.drivers.base import Observation
from harness.drivers.local_map import CELL, LocalMap, MapOptions
from harness.drivers.mppi import STEPS, blended
from harness.drivers.rollout import AHEAD, CLOSE, END, FARTHEST, NEAREST, ROOM, rolled, turned
from harness.samples import LaserScan, Twist
from tests.harness.drivers.jackal import ROVER, Pose, context, drives, lidar

DISC = 0.2  # [m] radius of what stands around


def scan(pose: Pose, discs: Sequence[tuple[float, float]]) -> NDArray[np.float32]:
    """Ranges to discs of 0.2 m, by the closed form of a ray and a circle."""
    x, y, angles = lidar(pose)
    ranges = np.full(len(angles), np.inf)
    for at_x, at_y in discs:
        along = (at_x - x) * np.cos(angles) + (at_y - y) * np.sin(angles)
        aside = (at_x - x) * np.sin(angles) - (at_y - y) * np.cos(angles)
        hit = (np.abs(aside) < DISC) & (along > 0.0)
        chord = np.sqrt(np.where(hit, DISC**2 - aside**2, 0.0))
        ranges = np.where(hit, np.minimum(ranges, along - chord), ranges)
    return ranges.astype(np.float32)


def seen(pose: Pose, discs: Sequence[tuple[float, float]]) -> Observation:
    return Observation(0, *pose, ranges=scan(pose, discs))


def test_what_was_seen_stays_until_a_beam_crosses_it() -> None:
    known, there = LocalMap(context(), MapOptions()), (12.0, 7.5)
    known.see(seen((10.0, 7.0, 0.3), [there]))
    known.plan((10.0, 7.0), (14.0, 8.0))
    towards = there[0] - DISC, there[1] - 0.03
    assert known.clearance[known.cell(towards)] <= 2 * CELL
    known.see(Observation(0, 9.0, 6.4, 2.0, ranges=None))
    known.plan((9.0, 6.4), (14.0, 8.0))
    assert known.clearance[known.cell(towards)] <= 2 * CELL
    known.see(seen((9.0, 6.4, 2.0), []))
    known.plan((9.0, 6.4), (14.0, 8.0))
    assert known.clearance[known.cell(towards)] > 100.0


def test_the_way_leads_around_a_wall() -> None:
    wall = [(2.0, y) for y in np.arange(-1.5, 1.6, 0.3)]
    known = LocalMap(context(), MapOptions())
    known.see(seen((0.0, 0.0, 0.0), wall))
    known.plan((0.0, 0.0), (4.0, 0.0))
    around = 2 * math.hypot(2.0, 1.5 + DISC)
    assert 4.0 < around < known.to_go[known.cell((0.0, 0.0))] < 2.0 * around


def way(name: str, goal: tuple[float, float], *discs: tuple[float, float]) -> tuple[np.ndarray, Twist]:
    """Where a driver comes in 15 s, of which the slowest takes 13, and its last command."""
    driver: Any = DRIVERS[name](context())
    driver.head_for(*goal, 0.0)
    poses, twists = zip(*drives(driver, partial(scan, discs=discs), 300), strict=True)
    return np.array(poses)[:, :2], twists[-1]


@pytest.mark.parametrize("name", ["beeline", "goal", "gap", "dwa", "mppi"])
def test_a_driver_reaches_its_goal_and_stands_there(name: str) -> None:
    wall = [(4.0, y) for y in np.arange(-1.0, 3.1, 0.3)]  # behind the goal it is in nobody's way
    places, last = way(name, (3.0, 1.0), *wall)
    assert math.dist(places[-1], (3.0, 1.0)) < 0.3
    assert np.hypot(*np.diff(places, axis=0).T).sum() < 3.3
    assert abs(last.linear) < 1e-6


@pytest.mark.parametrize(
    ("name", "touches"), [("beeline", True), ("gap", False), ("dwa", False), ("mppi", False)]
)
def test_who_looks_drives_around_what_stands_in_the_way(name: str, touches: bool) -> None:
    assert (LaserScan in DRIVERS[name].senses) != touches
    places, _ = way(name, (5.0, 0.0), (2.5, 0.05))
    nearest = np.hypot(*(places - (2.5, 0.05)).T).min()
    assert (nearest < DISC + 0.5 * ROVER.width) == touches
    assert math.dist(places[-1], (5.0, 0.0)) < 0.3


@pytest.mark.parametrize("room", [0.02, 0.07, 0.09, 0.2])
def test_who_follows_gaps_goes_on_until_its_bumper_is_8_cm_from_a_wall(room: float) -> None:
    (x, _, angles), ends = lidar((0.0, 0.0, 0.0)), (ROVER.footprint[1] + room, -1.0)
    with np.errstate(divide="ignore"):
        walls = [(end - x) / np.cos(angles) for end in ends]
        walls += [side / np.sin(angles) for side in (0.5, -0.5)]
    ranges = np.min([np.where(wall > 0.0, wall, np.inf) for wall in walls], axis=0).astype(np.float32)
    driver: Any = DRIVERS["gap"](context())
    driver.head_for(5.0, 0.0, 0.0)
    assert (driver.command(Observation(0, 0.0, 0.0, 0.0, ranges)).linear > 0.0) == (room > 0.08)


def test_a_direction_is_turned_as_by_sine_and_cosine() -> None:
    turn: Callable[..., tuple[float, float]] = turned.py_func  # type: ignore[attr-defined]
    for angle in (-0.4, 0.0, 0.1, 0.3):
        found = turn(math.cos(1.0), math.sin(1.0), angle)
        assert found == pytest.approx((math.cos(1.0 + angle), math.sin(1.0 + angle)), abs=1e-4)


def test_plans_are_blended_by_their_weights() -> None:
    plans = np.random.default_rng(3).normal(size=(50, STEPS, 2))
    costs = np.random.default_rng(4).uniform(0.0, 2.0, 50)
    weights = (1.0 + (costs - costs.min()) / 0.35) ** -4
    expected = (weights[:, None, None] * plans).sum(axis=0) / weights.sum()
    assert np.allclose(blended(plans, costs), expected)


def arc(speed: float, rate: float, time: float) -> tuple[float, float]:
    """Where a twist leads in a time, by its closed form."""
    if rate == 0.0:
        return speed * time, 0.0
    return speed / rate * math.sin(rate * time), speed / rate * (1.0 - math.cos(rate * time))


@pytest.mark.parametrize("twist", [(1.0, 0.0), (0.5, 0.8), (0.4, -0.9)])
def test_plans_are_driven_as_arcs_and_looked_up_where_they_lead(twist: tuple[float, float]) -> None:
    side = np.arange(200) * CELL
    to_go, clearance = np.meshgrid(side, side)  # of each cell its x, its y
    plans = np.full((1, 40, 2), twist)
    pose, outline = np.array([3.0, 4.0, 1.0, 0.0]), np.array([(0.2, 0.1, 0.05)])
    (told,) = rolled(clearance, to_go, pose, plans, 0.05, outline, 9.0, 0.3)
    times = np.linspace(0.05, 2.0, 40)
    ways, turns = [arc(*twist, time)[0] for time in times], twist[1] * times
    aside = [arc(*twist, time)[1] for time in times] + 0.2 * np.sin(turns) + 0.1 * np.cos(turns)
    assert told[END] == pytest.approx(3.0 + ways[-1], abs=2 * CELL)
    assert told[NEAREST] == pytest.approx(3.0 + min(ways), abs=2 * CELL)
    assert told[FARTHEST] == pytest.approx(3.0 + max(ways), abs=2 * CELL)
    assert told[AHEAD] == pytest.approx(3.0 + ways[-1] + 0.3 * math.cos(turns[-1]), abs=2 * CELL)
    assert told[ROOM] == pytest.approx(4.0 + aside.min() - 0.05, abs=2 * CELL)
    assert told[CLOSE] == pytest.approx(np.sum((1.0 - (4.0 + aside - 0.05) / 9.0) ** 2), rel=0.03)
