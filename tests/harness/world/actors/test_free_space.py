"""Where a body can walk, against distances to boxes that numpy works out."""

import math

import numpy as np

from harness.world.actors.free_space import FreeSpace, along, from_wall
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, orientation, outline

WALL = Obstacle(ObstacleKind.HAZARD, "box", (1.0, 0.2, 0.5), (2.0, 1.0, 0.5), orientation(0.5))
STONE = Obstacle(ObstacleKind.ROCK, "box", (0.3, 0.3, 0.1), (-2.0, 0.0, 0.0))
OBLONG = np.zeros((81, 61))


def space(*obstacles: Obstacle) -> FreeSpace:
    return FreeSpace(Heightfield(OBLONG, 0.1), obstacles)


def test_a_body_is_blocked_where_it_is_nearer_to_a_turned_wall_than_its_radius() -> None:
    points = np.random.default_rng(0).uniform((-0.5, -2.0), (2.5, 3.5), (300, 2))
    distances, feet = from_wall(points, outline(WALL))
    cos, sin = math.cos(0.5), math.sin(0.5)
    local = (points - (2.0, 1.0)) @ np.array([[cos, -sin], [sin, cos]])
    beyond = np.abs(local) - (1.0, 0.2)
    expected = np.linalg.norm(np.maximum(beyond, 0.0), axis=1) + np.minimum(beyond.max(axis=1), 0.0)
    np.testing.assert_allclose(distances, expected, atol=1e-9)
    np.testing.assert_allclose(np.linalg.norm(points - feet, axis=1), np.abs(expected), atol=1e-9)
    blocked = [space(STONE, WALL).blocked(point[None], 0.25) is not None for point in points]
    np.testing.assert_array_equal(blocked, expected < 0.25)


def test_the_first_point_that_is_blocked_is_reported() -> None:
    free = [(0.0, -1.0), (2.0, 1.6), (-2.0, 0.0)]  # the last one on the rock
    for point, radius, where in (
        *(((2.0, 1.0), 0.1, "through hazard_1"), ((2.0, 1.4), 0.25, "through hazard_1")),
        *(((2.6, 0.0), 0.25, "off the map"), ((math.nan, 0.0), 0.25, "off the map")),
    ):
        assert space(STONE, WALL).blocked(np.array(free), radius) is None
        later = (9.0, 9.0) if where == "off the map" else (2.0, 1.1)
        hit = space(STONE, WALL).blocked(np.array([*free, point, later]), radius)
        assert hit is not None
        assert hit[0] == where
        np.testing.assert_array_equal(hit[1], point)


def test_of_several_hazards_the_one_that_is_near_is_reported_and_seen() -> None:
    posts = [Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.1, 0.5), (x, -1.0, 0.5)) for x in (-1, 0, 1)]
    for index, post in enumerate(posts):
        point = np.array([post.position[0], -0.75])  # 15 cm from it, 81 cm from the next
        hit = space(*posts).blocked(np.array([(-1.0, -0.5), point]), 0.2)
        assert hit is not None
        assert hit[0] == f"through hazard_{index}"
        for aside in (np.array([0.0, 0.0]), np.array([0.0, -0.5])):  # behind it and in front
            (wall,) = space(*posts).walls_near(point + aside, 0.2)
            np.testing.assert_array_equal(wall, outline(post))
    assert space(*posts).walls_near(np.array([0.0, 2.0]), 1.0) == []


def test_a_leg_is_looked_at_all_along() -> None:
    assert space(WALL).blocked(along(((1.2, 1.6), (2.4, 0.4))), 0.25)
    assert not space(WALL).blocked(along(((1.2, 1.6), (1.3, 2.4))), 0.25)
    points = along(((0.0, 0.0), (1.0, 0.0), (1.0, 0.25)))
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).max() <= 0.1 + 1e-12
    assert [(1.0, 0.0) in map(tuple, points.tolist()), points[-1].tolist()] == [True, [1.0, 0.25]]
