import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.correlation import Correlation, combine, correlate
from rover_metrics.analysis.multiple import holm

RNG = np.random.default_rng(0)
NOISE = RNG.normal(size=(2, 300))


def found(x: object, y: object) -> Correlation:
    correlation = correlate("CV", "OC", np.asarray(x, float), np.asarray(y, float))
    assert correlation is not None
    return correlation


def test_of_independent_rows_it_is_scipys_spearman() -> None:
    x, y = NOISE[0], NOISE[0] + 2 * NOISE[1]
    expected = stats.spearmanr(x, y)
    result = found(x, y)
    assert result.rho == pytest.approx(expected.statistic)
    assert result.n == 300
    assert np.log10(result.p) == pytest.approx(np.log10(expected.pvalue), rel=0.15)


def test_two_random_walks_are_not_taken_for_related() -> None:
    alarms = naive = 0
    for seed in range(60):
        x, y = np.cumsum(np.random.default_rng(seed).normal(size=(2, 300)), axis=1)
        alarms += found(x, y).p < 0.05
        naive += stats.spearmanr(x, y).pvalue < 0.05
    assert naive > 40
    assert alarms <= 12


def test_only_rows_that_have_both_count() -> None:
    x, y = NOISE[0].copy(), NOISE[0].copy()
    x[:100], y[250:] = np.nan, np.nan
    assert found(x, y).n == 150
    assert found(x, y).rho == 1.0
    assert found(x, y).p == 0.0


def test_constant_or_few_values_have_no_correlation() -> None:
    assert correlate("CV", "OC", NOISE[0], np.ones(300)) is None
    assert correlate("CV", "OC", NOISE[0][:9], NOISE[1][:9]) is None


def test_logs_are_combined_within_so_that_their_difference_is_no_correlation() -> None:
    low, high = NOISE, NOISE + 100
    pooled = stats.spearmanr(np.concatenate((low[0], high[0])), np.concatenate((low[1], high[1])))
    assert pooled.statistic > 0.7
    result = combine([found(*low), found(*high)])
    assert result.rho == pytest.approx(found(*low).rho)
    assert result.n == 600
    assert combine([found(*low)]) == found(*low)


def test_holm_adjusts_as_in_the_textbook() -> None:
    assert holm([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
    assert holm([0.5, None, 0.9]) == [1.0, None, 1.0]
