"""Heights between vertices, filled gaps and coarser grids."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.world.heightfield import Heightfield, filled, resampled

Array = NDArray[np.float64]


def test_heights_are_those_of_two_triangles_a_cell_and_of_one_point_as_of_many() -> None:
    """Rows run with y, columns with x; to the bit."""
    ground = Heightfield(np.array([[0.0, 1.0, 0.0], [2.0, 5.0, 0.0]]), 2.0, (10.0, -1.0))
    x, y = np.array([(9.0, -1.5), (8.5, -0.5), (9.99, -1.99), (8.0, 0.0), (10.0, -2.0)]).T
    assert ground.heights_at(x, y) == pytest.approx([1.5, 2.25, 1.015, 2.0, 1.0])
    rng = np.random.default_rng(0)
    moved = Heightfield(rng.normal(0.0, 0.2, (41, 67)), 0.1, (1.7, -0.4))
    beyond = rng.uniform(-1.3, 1.3, (500, 2)) * moved.half_size
    vertices = np.stack(np.meshgrid(np.arange(-34, 35), np.arange(-21, 22)), axis=-1).reshape(-1, 2)
    x, y = (np.vstack([beyond, 0.1 * vertices]) + moved.middle).T
    assert [moved.height_at(*at) for at in zip(x, y, strict=True)] == moved.heights_at(x, y).tolist()


def test_points_beyond_the_map_have_the_height_of_its_edge() -> None:
    ground = Heightfield(np.arange(12.0).reshape(3, 4), cell=0.5)
    assert ground.half_size == (0.75, 0.5)
    heights = [ground.height_at(x, y) for x, y in ((99.0, 99.0), (0.75, -99.0), (-99.0, -99.0))]
    assert heights == [11.0, 3.0, 0.0]


def test_gaps_are_filled_by_means_of_what_is_around() -> None:
    values = np.tile(np.arange(57.0), (40, 1))
    gaps = values.copy()
    gaps[10:15, 20:26] = gaps[-1, -1] = gaps[0, 1] = np.nan
    found = filled(gaps)
    assert np.array_equal(found[~np.isnan(gaps)], values[~np.isnan(gaps)])
    assert found == pytest.approx(values, abs=3.0)
    assert (np.diff(found[10:15, 20:26], axis=1) > 0.0).all()  # it still climbs


@pytest.mark.parametrize("step", [(3.0, 3.0), (2.6, 1.2), (0.5, 4.4), (4.0, 4.0)])
def test_coarser_cells_are_means_around_their_places_in_the_middle(step: tuple[float, float]) -> None:
    rng, (row, column) = np.random.default_rng(0), np.mgrid[0:64, 0:61].astype(float)
    y, x = (step[axis] * (np.arange(11.0) - 5.0) for axis in (0, 1))
    places = 0.3 * (31.5 + y[:, None]) - 0.7 * (30.0 + x)
    assert resampled(0.3 * row - 0.7 * column, step, (11, 11)) == pytest.approx(places)
    spread = resampled(rng.normal(size=row.shape), step, (11, 11)).std()
    averaged = [2 * (round(stride) // 2) + 1 for stride in step]
    assert spread == pytest.approx(1.0 / np.sqrt(averaged[0] * averaged[1]), rel=0.45)
