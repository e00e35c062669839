import math
from dataclasses import replace

import numpy as np
import pytest

from harness.errors import UsageError
from harness.gym.places import Places
from harness.robots import find_rover
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

LEO = find_rover("leo")
# A wall along y at x = 1 from edge to edge: the part on its left is the larger one.
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 6.0, 0.5), (1.0, 0.0, 0.5))
POST = Obstacle(ObstacleKind.HAZARD, "cylinder", (0.2, 0.5), (-2.0, 0.5, 0.5))


def world(*obstacles: Obstacle) -> World:
    return World("made", Heightfield(np.zeros((41, 41)), 0.25), obstacles, seed=0, difficulty=None)


def test_places_are_where_the_rover_fits_and_only_on_one_side_of_a_wall() -> None:
    x, y = Places(world(WALL, POST), LEO).middles.T
    reach = math.hypot(0.218, 0.214)  # of the wheels, from the middle
    assert x.min() >= -4.5 + reach  # half a metre from the edge a run ends
    assert x.max() <= 0.9 - reach
    assert np.hypot(x + 2.0, y - 0.5).min() >= 0.2 + reach
    covered = 0.2 * 0.2 * len(x)
    margin = reach + 0.15
    room = (4.5 + 0.9 - 2 * margin) * (9.0 - 2 * margin) - math.pi * (0.2 + margin) ** 2
    assert covered == pytest.approx(room, rel=0.1)  # nor is much left out


def test_a_rover_that_is_long_on_one_side_keeps_its_longest_reach_free() -> None:
    rover = replace(LEO, footprint=(-0.2, 0.6, -0.3, 0.1))
    x, y = Places(world(), rover).middles.T
    assert max(np.abs(x).max(), np.abs(y).max()) <= 4.5 - math.hypot(0.6, 0.3)


def test_draws_are_as_wanted_and_spread_over_all_that_is() -> None:
    places, rng = Places(world(), LEO), np.random.default_rng(0)
    drawn = np.array([places.draw(rng, (1.0, 1.0), (1.0, 2.0)) for _ in range(200)])
    assert (drawn == drawn.round(3)).all()  # can be typed after --start
    away = np.hypot(*(drawn - 1.0).T)
    assert (away >= 1.0).all()
    assert (away <= 2.0).all()
    assert np.abs(drawn.mean(axis=0) - 1.0).max() < 0.3
    boxed = np.array([places.draw(rng, (0.0, 0.0), (0.0, math.inf), 0.5) for _ in range(50)])
    assert 0.3 < np.abs(boxed).max() <= 0.6  # by half a cell


@pytest.mark.parametrize(("distance", "box"), [((30.0, 40.0), math.inf), ((0.0, math.inf), 0.01)])
def test_where_nothing_is_as_wanted_the_nearest_is_taken(
    distance: tuple[float, float], box: float
) -> None:
    places, rng = Places(world(), LEO), np.random.default_rng(0)
    x, y = places.draw(rng, (0.0, 0.0), distance, box)
    if box == math.inf:
        assert math.hypot(x, y) > 5.0  # a corner
    else:
        assert max(abs(x), abs(y)) <= 0.2


def test_a_map_without_room_is_told() -> None:
    slab = Obstacle(ObstacleKind.HAZARD, "box", (6.0, 6.0, 0.5), (0.0, 0.0, 0.5))
    with pytest.raises(UsageError, match="leo can stand nowhere on made"):
        Places(world(slab), LEO)
