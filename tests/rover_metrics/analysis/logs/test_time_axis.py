import numpy as np
import pytest

from rover_metrics.analysis.logs.time_axis import TimeAxis, on_grid

STAMPS = np.array([100.0, 101.0, 102.0, 104.0])
VALUES = np.array([1.0, 3.0, np.nan, 7.0])


def test_percentage_runs_from_0_to_100() -> None:
    x, y = TimeAxis("percentage", 1.0).place(STAMPS, VALUES)
    assert x.tolist() == [0, 25, 50, 100]
    np.testing.assert_array_equal(y, VALUES)


def test_a_fixed_interval_averages_and_leaves_empty_intervals_out() -> None:
    x, y = TimeAxis("fixed_interval", 2.0).place(STAMPS, VALUES)
    assert x.tolist() == [0, 4]
    assert y.tolist() == [2, 7]
    x, _ = TimeAxis("fixed_interval", 1e-9).place(STAMPS, VALUES)
    assert x == pytest.approx([0, 1, 4])


def test_tenths_of_a_second_fall_into_their_own_intervals() -> None:
    stamps = np.array([5 + 0.1 * i for i in range(50)])
    x, y = TimeAxis("fixed_interval", 0.1).place(stamps, np.arange(50.0))
    assert x == pytest.approx(0.1 * np.arange(50))
    assert y.tolist() == list(range(50))


def test_none_keeps_the_rows_as_recorded() -> None:
    x, y = TimeAxis("none", 1.0).place(STAMPS, VALUES)
    assert x.tolist() == [0, 1, 2, 4]
    np.testing.assert_array_equal(y, VALUES)


def test_an_episode_of_one_row_has_a_place_too() -> None:
    assert TimeAxis("percentage", 1.0).place(STAMPS[:1], VALUES[:1])[0].tolist() == [0]


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


def test_labels_say_what_the_axis_shows() -> None:
    assert TimeAxis().label == "Share of the episode [%]"
    assert TimeAxis("none").label == "Time since the episode began [s]"
    assert TimeAxis("fixed_interval", 0.5).label == (
        "Time since the episode began [s], means over 0.5 s"
    )


def test_a_row_at_the_end_of_an_interval_is_of_the_next() -> None:
    x, y = TimeAxis("fixed_interval").place(np.array([7.0, 7.998, 8.0, 8.9]), np.arange(4.0))
    assert (x.tolist(), y.tolist()) == ([0, 1], [0.5, 2.5])
