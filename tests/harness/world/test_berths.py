"""Where there is room for one more rover."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.world.berths import GAP, berth, overlaps
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.support.rovers import LEO, ROVER_ZERO4WD

FLAT = Heightfield(np.zeros((81, 81)), 0.1)


def world(*obstacles: Obstacle, ground: Heightfield = FLAT) -> World:
    return World("bench", ground, obstacles, seed=0, difficulty=0.0)


def test_discs_overlap_when_they_are_nearer_than_their_radii_and_the_gap() -> None:
    assert not overlaps((0.0, 0.0, 1.0), [(3.0, 0.0, 2.0)])
    assert overlaps((0.0, 0.0, 1.0), [(9.0, 9.0, 1.0), (2.99, 0.0, 2.0)])
    assert overlaps((0.0, 0.0, 1.0), [(3.4, 0.0, 2.0)], gap=0.5)
    assert not overlaps((0.0, 0.0, 1.0), [])


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_the_places_beside_are_taken_left_right_behind_ahead(yaw: float) -> None:
    radius = math.hypot(*(max(map(abs, LEO.footprint[n : n + 2])) for n in (0, 2)))
    assert LEO.reach == pytest.approx(radius)
    pitch, taken = 2 * radius + GAP, [(0.3, -0.2, radius)]
    found = []
    for _ in range(4):
        place = berth((0.3, -0.2, yaw), LEO, taken, world())
        assert place is not None
        ahead, left = np.subtract(place[:2], (0.3, -0.2)) @ [
            [math.cos(yaw), -math.sin(yaw)],
            [math.sin(yaw), math.cos(yaw)],
        ]
        found.append((round(ahead / pitch, 6), round(left / pitch, 6), place[2]))
        taken.append((*place[:2], radius))
    assert found == [(0, 1, yaw), (0, -1, yaw), (-1, 0, yaw), (1, 0, yaw)]


def test_places_are_as_far_apart_as_the_larger_rover_needs() -> None:
    place = berth((0.0, 0.0, 0.0), LEO, [(0.0, 0.0, ROVER_ZERO4WD.reach)], world())
    assert place == pytest.approx((0.0, LEO.reach + ROVER_ZERO4WD.reach + GAP, 0.0))


@pytest.mark.parametrize(("gap", "side"), [(GAP - 0.01, -1), (GAP, 1)])
def test_a_place_keeps_its_gap_from_every_disc_not_only_from_the_nearest(gap: float, side: int) -> None:
    pitch = 2 * LEO.reach + GAP
    other = (2 * LEO.reach + gap, pitch, LEO.reach)  # ahead of the place on the left
    place = berth((0.0, 0.0, 0.0), LEO, [(0.0, 0.0, LEO.reach), other], world())
    assert place == pytest.approx((0.0, side * pitch, 0.0))


def test_neither_rocks_nor_hazards_nor_steep_ground_nor_the_edge_are_room() -> None:
    start, taken = (0.0, 0.0, 0.0), [(0.0, 0.0, LEO.reach)]
    pitch = 2 * LEO.reach + GAP
    pebble = Obstacle(ObstacleKind.ROCK, "box", (0.03, 0.03, 0.03), (0.0, pitch, 0.0))
    post = Obstacle(ObstacleKind.HAZARD, "cylinder", (0.1, 0.5, 0.0), (0.0, -pitch, 0.5))
    assert berth(start, LEO, taken, world(pebble, post)) == pytest.approx((-pitch, 0.0, 0.0))
    x = np.linspace(-4.0, 4.0, 81)
    steep = Heightfield(np.tile(np.where(x < -0.3, -2.0 * (x + 0.3), 0.0), (81, 1)), 0.1)
    assert berth(start, LEO, taken, world(pebble, post, ground=steep)) == pytest.approx(
        (pitch, 0.0, 0.0)
    )
    beside = Obstacle(ObstacleKind.HAZARD, "cylinder", (0.05, 0.5), (0.0, pitch + 0.9 * LEO.reach, 0.5))
    far = replace(beside, position=(0.0, pitch + 1.5 * LEO.reach, 0.5))
    assert berth(start, LEO, taken, world(beside)) == pytest.approx((0.0, -pitch, 0.0))
    assert berth(start, LEO, taken, world(far)) == pytest.approx((0.0, pitch, 0.0))
    tiny = Heightfield(np.zeros((15, 15)), 0.1)
    assert berth(start, LEO, taken, world(ground=tiny)) is None
