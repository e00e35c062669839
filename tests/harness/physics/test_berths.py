"""Where there is room for one more rover."""

import math

import numpy as np
import pytest

from harness.physics.berths import GAP, berth
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.support.rovers import LEO, ROVER_ZERO4WD

FLAT = Heightfield(np.zeros((81, 81)), 0.1)
PITCH = 2 * LEO.reach + GAP
LEFT, RIGHT, BEHIND, AHEAD = (0.0, PITCH), (0.0, -PITCH), (-PITCH, 0.0), (PITCH, 0.0)


def place(*obstacles: Obstacle, ground: Heightfield = FLAT) -> tuple[float, float] | None:
    """Of one more Leo beside the one at 0,0."""
    world = World("bench", ground, obstacles, seed=0, difficulty=0.0)
    found = berth((0.0, 0.0, 0.0), LEO, [(0.0, 0.0, LEO.reach)], world)
    return found and found[:2]


def thing(x: float, y: float, kind: ObstacleKind = ObstacleKind.HAZARD, half: float = 0.05) -> Obstacle:
    return Obstacle(kind, "cylinder", (half, 0.5), (x, y, 0.0))


@pytest.mark.parametrize("yaw", [0.0, 2.0])
def test_the_places_beside_are_taken_left_right_behind_ahead(yaw: float) -> None:
    world, taken, found = World("bench", FLAT, (), 0, 0.0), [(0.3, -0.2, LEO.reach)], []
    turn = [[math.cos(yaw), -math.sin(yaw)], [math.sin(yaw), math.cos(yaw)]]
    for _ in range(4):
        one = berth((0.3, -0.2, yaw), LEO, taken, world)
        assert one is not None
        assert one[2] == yaw
        found.append(np.subtract(one[:2], (0.3, -0.2)) @ turn)
        taken.append((*one[:2], LEO.reach))
    np.testing.assert_allclose(found, [LEFT, RIGHT, BEHIND, AHEAD], atol=1e-9)
    wide = berth((0.0, 0.0, 0.0), LEO, [(0.0, 0.0, ROVER_ZERO4WD.reach)], world)
    assert wide == pytest.approx((0.0, LEO.reach + ROVER_ZERO4WD.reach + GAP, 0.0))


@pytest.mark.parametrize(("gap", "expected"), [(GAP - 0.01, RIGHT), (GAP, LEFT)])
def test_a_place_keeps_its_gap_from_every_disc(gap: float, expected: tuple[float, float]) -> None:
    other = (2 * LEO.reach + gap, PITCH, LEO.reach)  # ahead of the place on the left
    found = berth((0, 0, 0), LEO, [(0.0, 0.0, LEO.reach), other], World("bench", FLAT, (), 0, 0.0))
    assert found == pytest.approx((*expected, 0.0))


def test_neither_rocks_nor_hazards_nor_steep_ground_nor_the_edge_are_room() -> None:
    pebble, post = thing(*LEFT, ObstacleKind.ROCK, 0.03), thing(*RIGHT)
    assert place(pebble, post) == pytest.approx(BEHIND)
    x = np.linspace(-4.0, 4.0, 81)
    steep = Heightfield(np.tile(np.where(x < -0.3, -2.0 * (x + 0.3), 0.0), (81, 1)), 0.1)
    assert place(pebble, post, ground=steep) == pytest.approx(AHEAD)
    assert place(thing(0.0, PITCH + 0.9 * LEO.reach)) == pytest.approx(RIGHT)
    assert place(thing(0.0, PITCH + 1.5 * LEO.reach)) == pytest.approx(LEFT)
    assert place(ground=Heightfield(np.zeros((15, 15)), 0.1)) is None
