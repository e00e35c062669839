import math
from dataclasses import replace

import numpy as np
import pytest

from harness.base.errors import UsageError
from harness.gym.places import Places
from harness.robots import find_rover
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World

LEO = find_rover("leo")
AWAY = 64.0, -32.0
POST = Obstacle(ObstacleKind.HAZARD, "cylinder", (0.2, 0.5), (-2.0, 0.5, 0.5))


def world(*obstacles: Obstacle, middle: tuple[float, float] = (0.0, 0.0)) -> World:
    ground = Heightfield(np.zeros((41, 41)), 0.25, middle)
    return World("made", ground, obstacles, seed=0, difficulty=None)


def test_a_rover_does_not_pass_where_only_corners_of_cells_meet() -> None:
    blocks = [  # which leave two corners of the map that meet at (-1, -1)
        Obstacle(ObstacleKind.HAZARD, "box", (*half, 0.5), (*middle, 0.5))
        for half, middle in (((1.99, 2.99), (-3.01, 2.01)), ((2.99, 1.99), (2.01, -3.01)))
    ]
    tiny = LEO.but(footprint=(-0.01, 0.01, -0.01, 0.01))
    assert Places(world(*blocks), tiny).middles.min(axis=0) == pytest.approx([-0.9, -0.9])


def test_a_rover_that_is_long_on_one_side_keeps_its_longest_reach_free() -> None:
    for footprint in ((-0.2, 0.6, -0.3, 0.1), (-0.3, 0.1, -0.2, 0.6)):
        farthest = np.abs(Places(world(), LEO.but(footprint=footprint)).middles).max()
        assert 4.25 <= farthest + math.hypot(0.6, 0.3) <= 4.5


def test_draws_are_as_wanted_and_spread_over_all_that_is() -> None:
    places, rng = Places(world(), LEO), np.random.default_rng(0)
    drawn = np.array([places.draw(rng, (1.0, 1.0), (1.0, 2.0)) for _ in range(200)])
    assert (drawn != drawn.round(2)).any()
    assert (drawn == drawn.round(3)).all()  # can be typed after --start
    anywhere = [places.draw(rng, (0.0, 0.0), (0.0, math.inf)) for _ in range(2 * len(places.middles))]
    reached = {(x // 0.2, y // 0.2) for x, y in anywhere}  # of all cells a share of 1 - exp(-2)
    assert len(reached) == pytest.approx(0.865 * len(places.middles), rel=0.04)
    away = np.hypot(*(drawn - 1.0).T)
    assert (away >= 1.0).all()
    assert (away <= 2.0).all()
    assert np.abs(drawn.mean(axis=0) - 1.0).max() < 0.3
    places = Places(world(middle=AWAY), LEO)
    boxed = np.array([places.draw(rng, AWAY, (0.0, math.inf), 2.0) for _ in range(400)]) - AWAY
    assert 1.9 < np.abs(boxed).max() <= 2.0
    beyond = (np.hypot(*boxed.T) > 2.0).mean()  # of the disc, in the corners of the square
    assert beyond == pytest.approx(1.0 - math.pi / 4, abs=0.06)


def test_where_nothing_is_as_wanted_the_nearest_is_taken() -> None:
    places, rng = Places(world(), LEO), np.random.default_rng(0)
    assert math.hypot(*places.draw(rng, (0.0, 0.0), (30.0, 40.0))) > 5.0  # a corner
    middle = Places(world(middle=AWAY), LEO).draw(rng, AWAY, (0.0, math.inf), 0.01)
    assert np.abs(np.subtract(middle, AWAY)).max() <= 0.2
    others = [places.draw(rng, (0.0, 0.0), (0.0, math.inf), 0.15) for _ in range(20)]
    assert len({(x > 0.0, y > 0.0) for x, y in others}) == 4  # of its cells any
    # From (3, 0) at most 0.2 m, from the axes at most 0.15 m: at 1.475 m both miss by as much.
    x, y = places.draw(rng, (3.0, 0.0), (0.0, 0.2), 0.15)
    assert x == pytest.approx(1.475, abs=0.21)
    assert abs(y) < 0.7


def test_a_map_that_is_no_square_around_the_origin_has_its_places_where_it_is() -> None:
    ground = Heightfield(np.zeros((41, 61)), 0.25, middle=(20.0, -7.0))  # 15 m x 10 m
    post = replace(POST, position=(24.0, -6.0, 0.5))
    places = Places(World("made", ground, (post,), seed=0, difficulty=None), LEO)
    low, high = places.middles.min(axis=0), places.middles.max(axis=0)
    assert (low + high) / 2 == pytest.approx([20.0, -7.0])
    margin = 0.5 + math.hypot(0.218, 0.214) + 0.15  # of the edge, the rover, around it
    assert high - low == pytest.approx(2 * (np.array([7.5, 5.0]) - margin), abs=0.25)
    nearest = np.hypot(*(places.middles - (24.0, -6.0)).T).min()
    assert nearest == pytest.approx(0.2 + margin - 0.5, abs=0.2)
    rng = np.random.default_rng(0)
    drawn = np.array([places.draw(rng, (20.0, -7.0), (0.0, math.inf)) for _ in range(400)])
    within = ((drawn - low) / 0.2 + 0.5) % 1.0 - 0.5  # of a cell, from its middle
    assert np.abs(within).mean(axis=0) == pytest.approx([0.25, 0.25], abs=0.03)  # evenly
    assert within.mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.06)
    assert abs(np.corrcoef(within.T)[0, 1]) < 0.2


def test_a_rover_reaches_what_is_beyond_slopes_and_steps_that_it_climbs() -> None:
    x = np.linspace(-5.0, 5.0, 41)
    bumps = [np.maximum(1.0 - np.abs(x - 2.0), 0.0) * math.tan(angle) for angle in (0.5, 0.9)]
    kerbs = [np.where(x > 1.1, height, 0.0) for height in (0.05, 0.4)]  # Leo climbs 0.07 m
    for heights, is_beyond in ((bumps[0], 1), (bumps[1], 0), (kerbs[0], 1), (kerbs[1], 0)):
        ground = Heightfield(np.tile(heights, (41, 1)), 0.25)
        farthest = Places(replace(world(), ground=ground), LEO).middles[:, 0].max()
        assert (0.0 < farthest < 1.0) != is_beyond == (farthest > 3.5)


def test_a_map_without_room_is_told() -> None:
    slab = Obstacle(ObstacleKind.HAZARD, "box", (6.0, 6.0, 0.5), (0.0, 0.0, 0.5))
    with pytest.raises(UsageError, match="leo can stand nowhere on made"):
        Places(world(slab), LEO)
