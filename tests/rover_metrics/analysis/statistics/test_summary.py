"""A sample in numbers, against scipy and written-out formulas."""

import math

import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.autocorrelation import block_length, effective_size
from rover_metrics.analysis.statistics.summary import (
    RESAMPLES,
    Interval,
    block_bootstrap_interval,
    summarise,
    summarise_independent,
)

VALUES = np.array([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0])


def wilson(ones: int, n: int, confidence: float) -> Interval:
    """Wilson (1927): the shares whose normal interval just reaches what was seen."""
    z, p = stats.norm.ppf((1 + confidence) / 2), ones / n
    middle, half = p + z**2 / (2 * n), z * math.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    return tuple(100 * (middle + sign * half) / (1 + z**2 / n) for sign in (-1, 1))  # type: ignore[return-value]


def test_the_numbers_are_those_of_a_hand_calculation() -> None:
    summary = summarise(VALUES, np.ones(8), Kind.LEVEL, 0.9)
    assert (summary.n, summary.mean, summary.median) == (8, 5.0, 4.5)
    assert (summary.minimum, summary.maximum) == (2.0, 9.0)
    assert summary.sd == pytest.approx(np.sqrt(32 / 7))
    expected = stats.t.interval(0.9, 7, loc=5.0, scale=stats.sem(VALUES))
    assert summary.interval == pytest.approx(expected)
    assert summary.n_effective == effective_size(VALUES)
    assert (summary.bootstrap_interval, summary.block_length) == (None, None)  # too few rows
    weights = np.array([1.0, 3.0, 3.0, 1.0, 1.0, 1.0, 1.0, 5.0])
    weighted = summarise(VALUES, weights, Kind.COUNTER, 0.95)
    assert weighted.mean == pytest.approx((VALUES * weights).sum() / 16)
    assert weighted.interval is not None
    assert np.mean(weighted.interval) == pytest.approx(weighted.mean)


@pytest.mark.parametrize(
    ("ones", "n", "confidence"), [(1, 10, 0.95), (7, 9, 0.9), (0, 50, 0.95), (200, 300, 0.8)]
)
def test_a_flag_has_a_share_with_wilsons_interval(ones: int, n: int, confidence: float) -> None:
    values = np.repeat([0.0, 100.0], [n - ones, ones])
    summary = summarise(values, np.ones(n), Kind.FLAG, confidence)
    assert summary.n == n
    assert summary.mean == pytest.approx(100 * ones / n)
    assert summary.interval == pytest.approx(wilson(ones, n, confidence), abs=1e-9)
    assert summary.median is summary.sd is summary.minimum is summary.maximum is None
    assert summary.n_effective == effective_size(values)
    assert (summary.bootstrap_interval is None) == (n < 20 or ones == 0)


def test_constant_values_have_no_interval_and_none_have_no_number() -> None:
    for values in (np.full(50, 3.0), np.array([3.0])):
        summary = summarise(values, np.ones(values.size), Kind.LEVEL, 0.95)
        assert (summary.n, summary.mean) == (values.size, 3.0)
        assert summary.sd == (0.0 if values.size > 1 else None)
        assert summary.interval is summary.bootstrap_interval is None
    none = np.empty(0)
    for summary in (
        summarise(none, none, Kind.LEVEL, 0.95),
        summarise_independent(none, Kind.LEVEL, 0.95),
    ):
        assert (summary.n, summary.mean, summary.sd, summary.interval) == (0, None, None, None)


def test_independent_values_have_students_interval_and_a_share_none_beyond_0_and_100() -> None:
    values = np.array([0.0, 0.0, 0.0, 100.0])
    level, flag = (summarise_independent(values, kind, 0.95) for kind in (Kind.LEVEL, Kind.FLAG))
    assert level.interval == pytest.approx(stats.t.interval(0.95, 3, 25.0, stats.sem(values)))
    assert level.interval is not None
    assert flag.interval == pytest.approx((0.0, level.interval[1] if level.interval[1] < 100 else 100.0))
    mirrored = summarise_independent(100.0 - values, Kind.FLAG, 0.5).interval
    half = stats.t.ppf(0.75, 3) * stats.sem(values)
    assert mirrored == pytest.approx((75.0 - half, 75.0 + half))
    assert (level.n, level.n_effective, level.mean, level.bootstrap_interval) == (4, 4.0, 25.0, None)
    assert summarise_independent(values[3:], Kind.FLAG, 0.95).interval is None


@pytest.mark.parametrize("length", [1, 2, 7, 50])
def test_the_bootstrap_resamples_whole_blocks(length: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(length)
    values, weights = rng.normal(size=50).cumsum(), rng.uniform(0.5, 2.0, 50)
    draws, means = np.random.default_rng(0), []
    for _ in range(300):
        starts = draws.integers(50, size=math.ceil(50 / length))
        rows = [(start + i) % 50 for start in starts for i in range(length)]
        means.append(np.average(values[rows], weights=weights[rows]))
    monkeypatch.setattr("rover_metrics.analysis.statistics.summary.RESAMPLES", 300)
    monkeypatch.setattr("rover_metrics.analysis.statistics.summary._AT_ONCE", 700)
    found = block_bootstrap_interval(values, weights, length, 0.8)
    assert found == pytest.approx(np.percentile(means, [10, 90]))


def test_a_log_of_twenty_rows_or_more_is_resampled_in_its_best_blocks() -> None:
    values = np.random.default_rng(3).normal(size=20).cumsum()
    assert summarise(values[1:], np.ones(19), Kind.LEVEL, 0.95).bootstrap_interval is None
    summary = summarise(values, np.ones(20), Kind.LEVEL, 0.9)
    assert summary.block_length == block_length(values)
    assert RESAMPLES == 2000
    assert summary.bootstrap_interval == block_bootstrap_interval(
        values, np.ones(20), block_length(values), 0.9
    )


def test_a_long_log_is_resampled_in_five_thousand_blocks_at_most() -> None:
    values = np.random.default_rng(3).normal(10, 2, 20_001)
    assert block_length(values) < 5
    summary = summarise(values, np.ones(20_001), Kind.LEVEL, 0.95)
    assert summary.block_length == 5
    expected = stats.norm.interval(0.95, values.mean(), stats.sem(values))
    assert summary.bootstrap_interval == pytest.approx(expected, abs=0.003)
