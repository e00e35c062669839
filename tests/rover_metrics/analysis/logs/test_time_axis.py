import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Floats, TimeAxis, on_grid

STAMPS = np.array([100.0, 101.0, 102.0, 104.0])
VALUES = np.array([1.0, 3.0, np.nan, 7.0])
TENTHS = 0.1 * np.arange(50)


@pytest.mark.parametrize(
    ("axis", "stamps", "values", "x", "y"),
    [
        (TimeAxis(), STAMPS, VALUES, [0, 25, 50, 100], VALUES),
        (TimeAxis("none"), STAMPS, VALUES, [0, 1, 2, 4], VALUES),
        (TimeAxis(), STAMPS[:1], VALUES[:1], [0], VALUES[:1]),  # a single row has a place too
        # Means over intervals, and no empty ones; a row at the end of one is of the next.
        (TimeAxis("fixed_interval", 2.0), STAMPS, VALUES, [0, 4], [2, 7]),
        (TimeAxis("fixed_interval", 1e-9), STAMPS, VALUES, [0, 1, 4], [1, 3, 7]),
        (TimeAxis("fixed_interval"), [7.0, 7.998, 8.0, 8.9], [0, 1, 2, 3], [0, 1], [0.5, 2.5]),
        (TimeAxis("fixed_interval", 0.1), 5 + TENTHS, TENTHS, TENTHS, TENTHS),
    ],
)
def test_the_rows_of_an_episode_stand_where_the_axis_has_them(
    axis: TimeAxis, stamps: Floats, values: Floats, x: Floats, y: Floats
) -> None:
    at, means = axis.place(np.asarray(stamps, float), np.asarray(values, float))
    np.testing.assert_allclose(at, x, atol=1e-12)
    np.testing.assert_allclose(means, y, atol=1e-12)


def test_a_grid_averages_dense_rows_and_bridges_sparse_ones_but_not_the_ends() -> None:
    grid = np.array([0.0, 10.0, 20.0, 30.0, 40.0])
    sparse = on_grid(np.array([0.0, 20.0]), np.array([1.0, 3.0]), grid)
    np.testing.assert_allclose(sparse, [1, 2, 3, np.nan, np.nan])
    late = on_grid(np.array([20.0, 40.0]), np.array([1.0, 3.0]), grid)
    np.testing.assert_allclose(late, [np.nan, np.nan, 1, 2, 3])
    dense = on_grid(np.arange(41.0), np.arange(41.0), grid)
    np.testing.assert_allclose(dense, [2, 9.5, 19.5, 29.5, 37.5])
    shifted = on_grid(np.arange(41.0) + 100, np.arange(41.0), grid + 100)
    np.testing.assert_allclose(shifted, dense)
    assert np.isnan(on_grid(np.array([0.0]), np.array([np.nan]), grid)).all()
