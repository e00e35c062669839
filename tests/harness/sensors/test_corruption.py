"""The error models by themselves: each term alone, at its edges."""

import numpy as np
import pytest

from harness.sensors.corruption import AxisErrors, AxisTriad, ContactChatter, RangeErrors

SECOND_NS = 1_000_000_000
LIMITS = (0.15, 10.0)


def triad(seed: int = 2, **errors: float) -> AxisTriad:
    return AxisTriad(AxisErrors(**errors), np.random.default_rng(seed))


def ranges(values: list[float], limits: tuple[float, float] = LIMITS, **errors: float) -> list[float]:
    exact = np.array(values, dtype=np.float32)
    read = RangeErrors(**errors).corrupt(exact, limits, np.random.default_rng(3))
    assert read.dtype == np.float32
    np.testing.assert_array_equal(exact, np.array(values, dtype=np.float32))
    return [float(value) for value in read]


def test_without_errors_nothing_changes_and_nothing_is_drawn() -> None:
    rng = np.random.default_rng(1)
    axes = AxisTriad(AxisErrors(), rng)
    assert axes.corrupt((1.0, -2.0, 3e9), 0) == axes.corrupt((1.0, -2.0, 3e9), SECOND_NS) == (1, -2, 3e9)
    exact = np.array([0.15, 5.0, 10.0, np.inf, -np.inf, np.nan], dtype=np.float32)
    np.testing.assert_array_equal(RangeErrors().corrupt(exact, (0.1, 10.0), rng), exact)
    assert rng.random() == np.random.default_rng(1).random()


def test_a_bias_wanders_from_the_first_reading_on_by_the_root_of_the_time_between_two() -> None:
    wandering, draws = triad(walk=0.01), np.random.default_rng(2)
    assert wandering.corrupt((1.0, 2.0, 3.0), 5 * SECOND_NS) == (1.0, 2.0, 3.0)
    wandered = np.zeros(3)
    for stamp, elapsed in ((9.0, 4.0), (9.25, 0.25), (10.25, 1.0)):
        wandered += draws.normal(0.0, 0.01 * elapsed**0.5, 3)
        reading = wandering.corrupt((0.0, 0.0, 0.0), round(stamp * SECOND_NS))
        assert reading == pytest.approx(wandered)
    assert wandering.corrupt((0.0, 0.0, 0.0), round(10.25 * SECOND_NS)) == pytest.approx(wandered)


def test_a_bias_that_is_forgotten_is_drawn_anew_and_a_walk_comes_on_top() -> None:
    """b' = b exp(-t / T) + N(0, walk^2 t + bias^2 (1 - exp(-2 t / T))), as Gauss and Markov have it."""
    wandering, draws = triad(walk=0.3, bias=0.5, correlation_time=8.0), np.random.default_rng(2)
    bias, stamp = draws.normal(0.0, 0.5, 3), 7.0
    assert wandering.corrupt((0.0, 0.0, 0.0), 7 * SECOND_NS) == pytest.approx(bias)
    for elapsed in (0.25, 4.0, 16.0):
        stamp += elapsed
        variance = 0.3**2 * elapsed + 0.5**2 * (1 - np.exp(-2 * elapsed / 8.0))
        bias = bias * np.exp(-elapsed / 8.0) + draws.normal(0.0, variance**0.5, 3)
        reading = wandering.corrupt((1.0, 2.0, 3.0), round(stamp * SECOND_NS))
        assert reading == pytest.approx(bias + np.array([1.0, 2.0, 3.0]))


@pytest.mark.parametrize(("white", "bias", "variance"), [(3.0, 4.0, 25.0), (2.0, 0.0, 4.0), (0, 0, 0)])
def test_the_variance_is_that_of_all_that_a_first_reading_has(
    white: float, bias: float, variance: float
) -> None:
    assert AxisErrors(white=white, bias=bias, walk=9.0, step=9.0).variance == variance


def test_readings_come_in_steps_and_end_at_the_limit() -> None:
    stepped = triad(step=0.25, limit=4.1)
    assert stepped.corrupt((1.1, -0.2, 100.0), 0) == (1.0, -0.25, 4.1)
    assert stepped.corrupt((-100.0, 0.13, -0.12), 0) == (-4.1, 0.25, 0.0)


def test_a_range_at_a_limit_is_read_and_one_beyond_is_coded_as_rep_117_says() -> None:
    limits = (0.25, 8.0)  # exact in float32
    values = [0.25, np.nextafter(np.float32(0.25), 0), 8.0, np.nextafter(np.float32(8.0), 9), 0.0]
    assert ranges(values, limits) == [0.25, -np.inf, 8.0, np.inf, -np.inf]


def test_a_lost_return_is_a_miss_and_near_returns_and_faults_are_not_lost() -> None:
    read = np.array(ranges([5.0, -np.inf, np.nan, np.inf] * 5_000, dropout=0.1)).reshape(-1, 4)
    assert np.isposinf(read[:, 0]).mean() == pytest.approx(0.1, abs=0.02)
    assert set(read[:, 0]) == {5.0, np.inf}
    assert np.isneginf(read[:, 1]).all()
    assert np.isnan(read[:, 2]).all()
    assert np.isposinf(read[:, 3]).all()


def test_what_falls_is_caught_so_that_the_mean_load_is_the_weight() -> None:
    chatter = ContactChatter(
        speed=1e-3, shape=1.6, falling=0.04, landing=10.0, sliding_speed=1.0, friction=0.0
    )
    rng = np.random.default_rng(0)
    loads = np.array([chatter.shake((0.0, 0.0, 1.0), 1.0, rng)[2] for _ in range(60_000)])
    assert loads.mean() == pytest.approx(1.0, abs=0.015)
    assert (loads == 0.0).mean() == pytest.approx(0.04, abs=0.003)
    assert 30.0 < loads.max() < 200.0
