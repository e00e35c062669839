import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.roughness import RoughnessMap
from harness.world.statistics import residual_rms


def ground(heights: np.ndarray, cell: float = 0.05) -> Heightfield:
    return Heightfield(heights=heights, cell=cell)


def test_a_plane_of_any_incline_is_smooth() -> None:
    y, x = np.mgrid[-2:2:81j, -2:2:81j]
    assert RoughnessMap(ground(0.3 * x - 0.2 * y)).mean_square(0.5, -1.0) == pytest.approx(
        0.0, abs=1e-18
    )


def test_over_the_whole_map_it_is_the_statistic_of_the_terrain() -> None:
    heights = np.random.default_rng(0).normal(0.0, 0.01, (201, 201))
    rough = RoughnessMap(ground(heights))
    places = np.linspace(-4.0, 4.0, 161)
    mean = np.mean([rough.mean_square(float(x), float(y)) for x in places for y in places])
    assert np.sqrt(mean) == pytest.approx(residual_rms(ground(heights), 0.3), rel=0.02)


def test_it_is_local_and_x_runs_along_columns() -> None:
    heights = np.zeros((81, 81))
    heights[40, 60] = 0.1  # x = 1, y = 0
    rough = RoughnessMap(ground(heights))
    assert rough.mean_square(1.0, 0.0) > 1e-5
    assert rough.mean_square(0.0, 1.0) == 0.0
    assert rough.mean_square(1.0, 0.36) == 0.0


def test_it_reaches_to_the_edge_of_the_map_and_works_on_coarse_ones() -> None:
    heights = np.random.default_rng(1).normal(0.0, 0.01, (21, 21))
    rough = RoughnessMap(ground(heights, cell=0.5))
    for x, y in ((5.0, 5.0), (-5.0, -5.0), (4.9, -4.9)):
        assert rough.mean_square(x, y) > 0.0
