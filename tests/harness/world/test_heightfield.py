from collections.abc import Callable

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.world import World, build_world

TopAt = Callable[[float, float], float]


@pytest.mark.parametrize("name", ["flat", "slope", "gravel", "rocky", "washboard", "marsyard"])
def test_height_at_agrees_with_mujoco_between_the_vertices(
    name: str, ground_top: Callable[[World], TopAt]
) -> None:
    world = build_world(name, 3)
    top_at, reach = ground_top(world), world.ground.half_size - 0.01
    points = np.random.default_rng(0).uniform(-reach, reach, (300, 2))
    ours = [world.ground.height_at(x, y) for x, y in points]
    theirs = [top_at(x, y) for x, y in points]
    assert ours == pytest.approx(theirs, abs=1e-5)


def test_rows_run_with_y_and_columns_with_x(ground_top: Callable[[World], TopAt]) -> None:
    heights = np.zeros((5, 5))
    heights[4, 1] = 1.0
    world = World("spike", Heightfield(heights, cell=1.0), (), 0, 0.5)
    assert world.ground.height_at(-1.0, 2.0) == 1.0
    assert ground_top(world)(-1.0, 2.0 - 1e-6) == pytest.approx(1.0, abs=1e-4)


def test_points_beyond_the_map_have_the_height_of_its_edge() -> None:
    ground = Heightfield(np.arange(9.0).reshape(3, 3), cell=0.5)
    assert ground.half_size == 0.5
    assert ground.height_at(99.0, 99.0) == 8.0
    assert ground.height_at(-99.0, -99.0) == 0.0
