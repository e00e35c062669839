"""Helbing and Molnar's forces, written out, and a walker that obeys them."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from harness.spec.actor import ActorOptions
from harness.world.actors.free_space import FreeSpace
from harness.world.actors.random_walk import RandomWalk
from harness.world.actors.social_force import SocialForceWalker, step
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind

STILL, WANTED = np.zeros(2), np.array([1.0, 0.0])
SQUARE = np.array([[-1.0, 1.0], [1.0, 1.0], [1.0, 2.0], [-1.0, 2.0]])
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.2, 1.0, 0.5), (3.0, 0.0, 0.5))
GROUND = Heightfield(np.zeros((201, 201)), 0.1)
TICK_S = 0.01

Body = tuple[float, float, float]


def force(
    velocity: np.ndarray = STILL,
    bodies: Sequence[Body] = (),
    walls: Sequence[np.ndarray] = (),
    wanted: np.ndarray = WANTED,
) -> np.ndarray:
    seconds = 1e-6  # so short that nobody is too fast
    _, after = step(STILL, velocity, wanted, radius=0.25, bodies=bodies, walls=walls, seconds=seconds)
    return np.asarray((after - velocity) / seconds)


def at(degrees: float) -> Body:
    return math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.3


def pushed(degrees: float, share: float) -> tuple[float, float]:
    """By a body a metre away; what is more than 100 degrees aside counts half."""
    push = share * 7.0 * math.exp(-0.45 / 0.3)
    return 2.0 - push * at(degrees)[0], -push * at(degrees)[1]


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({}, (2.0, 0.0)),
        ({"velocity": np.array([0.5, 0.2])}, (1.0, -0.4)),
        ({"bodies": ((-1.0, 0.0, 0.3),)}, (2.0 + 0.5 * 7.0 * math.exp(-0.45 / 0.3), 0.0)),
        *(({"bodies": (at(a),)}, pushed(a, s)) for a, s in ((99, 1), (-99, 1), (101, 0.5), (-101, 0.5))),
        ({"bodies": ((0.0, 1.0, 0.3), (9.0, 0.0, 0.3), (0.0, 0.0, 0.3))}, (2.0, -7.0 * math.exp(-1.5))),
        ({"bodies": ((2.5, 0.0, 0.3),)}, (2.0 - 7.0 * math.exp(-1.95 / 0.3), 0.0)),
        ({"bodies": ((2.6, 0.0, 0.3),)}, (2.0, 0.0)),  # out of sight
        ({"bodies": ((0.1, 0.0, 0.3),)}, (2.0 - 7.0 * math.exp(0.25 / 0.3), 0.0)),  # not ever more
        ({"walls": (SQUARE,)}, (2.0, -50.0 * math.exp(-0.75 / 0.2))),
        ({"walls": (SQUARE + np.array([0.0, 1.2]),)}, (2.0, -50.0 * math.exp(-1.95 / 0.2))),
        ({"walls": (SQUARE + np.array([0.0, 1.3]),)}, (2.0, 0.0)),
        ({"walls": (SQUARE - np.array([0.0, 0.8]),)}, (2.0, 0.0)),  # who is in one is pushed by none
    ],
)
def test_forces_are_those_of_the_paper(given: dict[str, Any], expected: tuple[float, float]) -> None:
    assert force(**given) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("speed", [1.0, 0.5, 0.0])
def test_nobody_is_faster_than_in_a_hurry_and_a_step_is_the_speed(speed: float) -> None:
    fast, wanted = np.array([3.0, 4.0]), speed * WANTED
    place, velocity = step(STILL, fast, wanted, radius=0.25, bodies=(), walls=(), seconds=0.01)
    free = fast + 0.01 * (wanted - fast) / 0.5
    np.testing.assert_allclose(velocity, free * (1.3 * speed / np.linalg.norm(free)))
    np.testing.assert_allclose(place, 0.01 * velocity)


class WayPoints(RandomWalk):
    """Way points that a test gives; `asked` is the number of the last one that was asked for."""

    def __init__(self, *points: tuple[float, float]) -> None:
        self.given, self.asked = points, 0

    def point(self, index: int) -> tuple[float, float]:
        self.asked = index
        return self.given[index]


def walker(
    *points: tuple[float, float], obstacles: Sequence[Obstacle] = (WALL,), **options: float
) -> SocialForceWalker:
    space = FreeSpace(GROUND, obstacles)
    return SocialForceWalker(WayPoints(*points), space, ActorOptions.model_validate(options))


def walked(one: SocialForceWalker, seconds: float, bodies: Sequence[Body] = ()) -> np.ndarray:
    ticks = range(1, round(seconds / TICK_S) + 1)
    return np.array([(p.x, p.y) for n in ticks for p in [one.walk(n * TICK_S, TICK_S, bodies)]])


def test_after_a_restart_a_walk_is_the_same_whatever_was_seen_before() -> None:
    points = ((1.0, 0.0), (6.0, 0.5))  # the wall ahead is in sight
    one, new = walker(*points), walker(*points)
    begin = one.walk(0.0, 0.0, [])
    for seconds in (1.0, 0.05):
        walked(one, seconds)
        one.restart()
        assert one.walk(0.0, 0.0, []) == begin
    np.testing.assert_array_equal(walked(one, 1.0), walked(new, 1.0))


@pytest.mark.parametrize(
    ("begin", "limit", "ahead"),
    [
        (2.4, 2.8 - 0.25, (1.0, 0.0)),  # the wall begins at 2.8 m
        *((9.4, 9.5, ahead) for ahead in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0))),
    ],
)
def test_who_is_pushed_against_a_wall_or_to_an_edge_stands_there_and_goes_on_from_rest(
    begin: float, limit: float, ahead: tuple[float, float]
) -> None:
    x, y = ahead
    one = walker((begin * x, begin * y), (-5.0 * x, -5.0 * y))
    crowd = [((begin - 0.4) * x, (begin - 0.4) * y, 0.3)] * 9
    way = walked(one, 0.3, crowd) @ ahead
    assert limit - 0.02 < way[-1] == way.max() <= limit
    back = one.walk(0.31, TICK_S, [])
    acceleration = -1.0 / 0.5 - (50.0 * math.exp(-(limit - way[-1]) / 0.2) if limit < 9.0 else 0.0)
    speed = max(acceleration * TICK_S, -1.3)
    assert back.x * x + back.y * y - way[-1] == pytest.approx(speed * TICK_S, rel=1e-6)


@pytest.mark.parametrize(("distance", "heads_for"), [(0.501, 1), (0.499, 2)])
def test_a_way_point_is_reached_from_half_a_metre(distance: float, heads_for: int) -> None:
    points = WayPoints((0.0, 0.0), (distance, 0.0), (9.0, 0.0))
    one = SocialForceWalker(points, FreeSpace(GROUND, ()), ActorOptions())
    for time_s in (0.01, 0.02):
        one.walk(time_s, 0.0, [])
    assert points.asked == heads_for


def test_who_does_not_get_on_heads_for_the_next_point_after_twenty_seconds_more() -> None:
    points = WayPoints((0.0, 0.0), (5.0, 0.0), (0.0, 5.0), (9.0, 9.0))
    one = SocialForceWalker(points, FreeSpace(GROUND, ()), ActorOptions(speed=0.5))
    # Either leg takes 10 s.
    for time_s, heads_for in ((0.01, 1), (30.0, 1), (30.02, 2), (60.0, 2), (60.04, 3)):
        one.walk(time_s, 0.0, [])
        assert points.asked == heads_for


def test_a_walker_is_as_fast_as_wide_and_as_late_as_its_options_say() -> None:
    """By its first step: 2 m/s within half a second, and Helbing's push of a body a metre away."""
    one = walker((0.0, 5.0), (9.0, 5.0), speed=2.0, radius=0.6, delay=1.0)
    assert (walked(one, 1.0) == (0.0, 5.0)).all()
    alone = one.walk(1.01, TICK_S, [])
    assert alone.x == pytest.approx(4.0 * TICK_S**2)
    one.restart()
    pushed = one.walk(1.01, TICK_S, [(1.0, 5.0, 0.3)])
    assert (alone.x - pushed.x) / TICK_S**2 == pytest.approx(7.0 * math.exp(-(1.0 - 0.3 - 0.6) / 0.3))
