import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.autocorrelation import (
    autocorrelation,
    block_length,
    effective_pairs,
    effective_size,
)
from rover_metrics.analysis.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.summary import (
    block_bootstrap_interval,
    summarise,
    summarise_independent,
)


def autoregressive(phi: float, n: int, seed: int = 0) -> Floats:
    """x[i] = phi x[i - 1] + noise."""
    noise = np.random.default_rng(seed).normal(size=n)
    values = np.empty(n)
    values[0] = noise[0] / np.sqrt(1 - phi**2)
    for i in range(1, n):
        values[i] = phi * values[i - 1] + noise[i]
    return values


def test_the_numbers_are_those_of_a_hand_calculation() -> None:
    values = np.array([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0])
    summary = summarise(values, np.ones(8), Kind.LEVEL, 0.95)
    assert (summary.n, summary.mean, summary.median) == (8, 5.0, 4.5)
    assert (summary.minimum, summary.maximum) == (2.0, 9.0)
    assert summary.sd == pytest.approx(np.sqrt(32 / 7))
    expected = stats.t.interval(0.95, 7, loc=5.0, scale=stats.sem(values))
    assert summary.interval == pytest.approx(expected)
    assert summary.bootstrap_interval is None  # eight rows make no blocks


def test_a_higher_level_of_confidence_widens_both_intervals() -> None:
    values = autoregressive(0.5, 400)
    narrow, wide = (summarise(values, np.ones(400), Kind.LEVEL, level) for level in (0.8, 0.99))
    for name in ("interval", "bootstrap_interval"):
        assert np.ptp(getattr(wide, name)) > 1.5 * np.ptp(getattr(narrow, name))


def test_weights_decide_the_mean() -> None:
    summary = summarise(np.array([60.0, 0.0]), np.array([1.0, 3.0]), Kind.COUNTER, 0.95)
    assert summary.mean == 15.0


def test_a_flag_has_a_share_with_wilsons_interval_and_no_median() -> None:
    summary = summarise(np.array([0.0] * 9 + [100.0]), np.ones(10), Kind.FLAG, 0.95)
    assert summary.mean == 10.0
    assert summary.interval == pytest.approx((1.787621, 40.41500))  # Wilson's for 1 of 10
    assert summary.median is summary.sd is summary.minimum is None


def test_constant_values_have_no_interval_and_a_flag_that_is_never_set_has_one() -> None:
    constant = summarise(np.full(50, 3.0), np.ones(50), Kind.LEVEL, 0.95)
    assert (constant.mean, constant.sd) == (3.0, 0.0)
    assert constant.interval is constant.bootstrap_interval is None
    never = summarise(np.zeros(50), np.ones(50), Kind.FLAG, 0.95)
    assert never.interval is not None
    assert never.interval[1] == pytest.approx(7.135, abs=0.01)


def test_one_value_and_none_have_no_spread() -> None:
    one = summarise(np.array([3.0]), np.ones(1), Kind.LEVEL, 0.95)
    assert (one.n, one.mean, one.sd, one.interval) == (1, 3.0, None, None)
    assert summarise(np.empty(0), np.empty(0), Kind.LEVEL, 0.95).mean is None


def test_an_interval_for_shares_of_logs_stays_within_0_and_100() -> None:
    summary = summarise_independent(np.array([0.0, 0.0, 0.0, 100.0]), Kind.FLAG, 0.95)
    assert summary.interval == (0.0, 100.0)


def test_autocorrelation_is_that_of_its_definition_also_over_segments(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    values = autoregressive(0.7, 500)
    centred = values - values.mean()
    direct = [float(centred[: 500 - k] @ centred[k:]) for k in range(6)]
    np.testing.assert_allclose(autocorrelation(values, 5), np.array(direct) / direct[0])
    monkeypatch.setattr("rover_metrics.analysis.autocorrelation._SEGMENT", 100)
    np.testing.assert_allclose(autocorrelation(values, 5), np.array(direct) / direct[0], atol=0.05)


def test_effective_size_is_that_of_theory() -> None:
    n = 20_000
    assert effective_size(autoregressive(0.0, n)) == pytest.approx(n, rel=0.05)
    assert effective_size(autoregressive(0.8, n)) == pytest.approx(n * 0.2 / 1.8, rel=0.2)
    x, y = autoregressive(0.8, n, seed=1), autoregressive(0.8, n, seed=2)
    theory = n * (1 - 0.64) / (1 + 0.64)
    assert effective_pairs(x, y) == pytest.approx(theory, rel=0.2)
    assert effective_pairs(x, autoregressive(0.0, n)) == pytest.approx(n, rel=0.1)


def test_block_length_is_that_of_theory() -> None:
    n, phi = 20_000, 0.7
    theory = (1.5 * (2 * phi / (1 - phi**2)) ** 2 * n) ** (1 / 3)
    assert block_length(autoregressive(phi, n)) == pytest.approx(theory, rel=0.35)
    assert block_length(autoregressive(0.0, n)) <= 5
    assert block_length(np.cumsum(np.ones(30))) <= 10  # at most a third


def test_the_block_bootstrap_covers_where_the_t_interval_does_not() -> None:
    covered = {"interval": 0, "bootstrap_interval": 0}
    for seed in range(60):
        summary = summarise(autoregressive(0.8, 600, seed), np.ones(600), Kind.LEVEL, 0.95)
        for name in covered:
            low, high = getattr(summary, name)
            covered[name] += low <= 0.0 <= high
    assert covered["interval"] < 42  # in theory 48 % of 60
    assert covered["bootstrap_interval"] >= 50


def test_the_bootstrap_of_independent_values_is_close_to_students_t() -> None:
    values = np.random.default_rng(3).normal(10, 2, 500)
    low, high = block_bootstrap_interval(values, np.ones(500), 1, 0.95)
    expected = stats.t.interval(0.95, 499, loc=values.mean(), scale=stats.sem(values))
    assert (low, high) == pytest.approx(expected, abs=0.03)
    assert (low, high) == block_bootstrap_interval(values, np.ones(500), 1, 0.95)
