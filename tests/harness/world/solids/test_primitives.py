"""Primitives on a slope: how high they are above the lowest ground below them, and where they end."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.world.heightfield import Heightfield
from harness.world.obstacles import ObstacleKind, Shape
from harness.world.solid import Primitive, Solid
from harness.world.solids.pieces import obstacle_of
from tests.harness.world.solids.shapes import at

SLOPE = 0.5  # along x
HEIGHTS = SLOPE * np.tile(np.arange(-20.0, 21.0), (21, 1)) * 0.5
HEIGHTS[16, 26] -= 1.0  # a hole at x = 103, y = 3
GROUND = Heightfield(HEIGHTS, 0.5, (100.0, 0.0))
RED = (1.0, 0.0, 0.0, 1.0)


def solid(
    position: tuple[float, float, float],
    shape: Shape = "box",
    half_size: tuple[float, ...] = (0.5, 0.5, 0.2),
    turned: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Solid:
    return Solid("s", Primitive(shape, half_size), at(*position, *turned), color=RED)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("made", "height"),
    [
        (solid((100.0, 0.0, 1.0)), 1.2 + SLOPE * 0.5),
        (solid((102.0, 0.0, 1.0)), 0.2 + SLOPE * 0.5),
        (solid((103.0, 3.0, 2.0)), 2.2 + 1.0 - SLOPE * 3.0),
        (solid((100.0, 0.0, 1.0), turned=(0.0, 0.0, math.pi / 4)), 1.2 + SLOPE * math.sqrt(0.5)),
        (solid((100.0, 0.0, 1.0), turned=(0.0, math.pi / 2, 0.0)), 1.5 + SLOPE * 0.2),
        (solid((100.0, 0.0, 1.0), "cylinder", (0.5, 0.2)), 1.2 + SLOPE * 0.5),
        (solid((100.0, 0.0, 1.0), "ellipsoid", (0.3, 0.5, 0.2)), 1.2 + SLOPE * 0.3),
        (solid((110.3, 0.0, 6.0)), 6.2 - SLOPE * 9.8),  # what is off the map has no ground
        (solid((100.0, 0.0, -0.445)), 0.005 + 1e-9),
        (solid((100.0, 0.0, -0.446)), None),  # flush with the ground
        *((solid(place), None) for place in ((100.0, 5.4, -9.0), (90.0, 5.6, 9.0))),
    ],
)
def test_its_kind_is_that_of_its_top_above_the_lowest_ground_below_it(
    made: Solid, height: float | None
) -> None:
    asked = list[float]()

    def kind(of_top: float) -> ObstacleKind:
        asked.append(of_top)
        return ObstacleKind.ROCK

    obstacle = obstacle_of(made, GROUND, kind)
    if height is None:
        assert obstacle is None
        return
    assert asked == pytest.approx([height], abs=2e-6)
    assert obstacle is not None
    assert isinstance(made.shape, Primitive)
    assert (obstacle.kind, obstacle.color) == (ObstacleKind.ROCK, RED)
    assert (obstacle.shape, obstacle.half_size) == (made.shape.shape, made.shape.half_size)
    assert obstacle.position == pytest.approx(made.pose[:3, 3])
    w, x, y, z = obstacle.quaternion
    assert w >= 0.0, "of the two that mean this turn"
    assert Rotation.from_quat([x, y, z, w]).as_matrix() == pytest.approx(made.pose[:3, :3])
