import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.statistics import RoughnessMap


def ground(heights: np.ndarray, cell: float = 0.05) -> Heightfield:
    return Heightfield(heights=heights, cell=cell)


def test_a_plane_of_any_incline_is_smooth() -> None:
    y, x = np.mgrid[-2:2:81j, -2:2:81j]
    assert RoughnessMap(ground(0.3 * x - 0.2 * y)).mean_square(0.5, -1.0) == pytest.approx(
        0.0, abs=1e-18
    )


def mean_square(heights: np.ndarray, row: int, column: int, reach: int) -> float:
    """Over the window around a vertex, of the height above the mean of the window around each."""

    def window(r: int, c: int) -> np.ndarray:
        return heights[r - reach : r + reach + 1, c - reach : c + reach + 1]

    near = range(-reach, reach + 1)
    above = [
        heights[row + r, column + c] - window(row + r, column + c).mean() for r in near for c in near
    ]
    return float(np.mean(np.square(above)))


@pytest.mark.parametrize(("cell", "reach"), [(0.05, 3), (0.1, 1), (0.5, 1)])
def test_it_is_the_mean_square_residual_around_the_nearest_vertex(cell: float, reach: int) -> None:
    heights = np.random.default_rng(0).normal(0.0, 0.01, (41, 41))
    rough = RoughnessMap(ground(heights, cell))
    half = 20 * cell
    for row, column in ((20, 20), (12, 30), (2 * reach, 40 - 2 * reach)):
        expected = pytest.approx(mean_square(heights, row, column, reach))
        x, y = column * cell - half, row * cell - half
        assert rough.mean_square(x, y) == expected
        assert rough.mean_square(x + 0.49 * cell, y - 0.49 * cell) == expected
        assert rough.mean_square(x - 0.49 * cell, y + 0.49 * cell) == expected


def test_near_the_edge_the_nearest_value_that_there_is_stands() -> None:
    heights = np.random.default_rng(1).normal(0.0, 0.01, (21, 21))
    rough = RoughnessMap(ground(heights, cell=0.5))
    for x, y, row, column in (
        (5.0, 5.0, 18, 18),
        (-5.0, -5.0, 2, 2),
        (4.9, -4.9, 2, 18),
        (0, 5, 18, 10),
    ):
        assert rough.mean_square(x, y) == pytest.approx(mean_square(heights, row, column, 1))
