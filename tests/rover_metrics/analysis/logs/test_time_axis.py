import numpy as np

from rover_metrics.analysis.logs.log import on_grid


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
