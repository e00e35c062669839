"""Rank correlations of rows that repeat each other, against scipy and written-out formulas."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.statistics.autocorrelation import effective_pairs
from rover_metrics.analysis.statistics.correlation import Correlation, combine, correlate

NOISE = np.random.default_rng(0).normal(size=(2, 300))
WALKS = NOISE.cumsum(axis=1)


def found(x: object, y: object) -> Correlation:
    correlation = correlate("CV", "OC", np.asarray(x, float), np.asarray(y, float))
    assert correlation is not None
    return correlation


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (NOISE[0], NOISE[0] + 2 * NOISE[1]),
        (NOISE[0].round(), -(NOISE[0] + NOISE[1]).round()),  # ties
        (WALKS[0], WALKS[1]),
        (WALKS[0][:10], WALKS[1][:10]),
    ],
)
def test_it_is_spearmans_with_a_t_test_on_the_effective_pairs(x: object, y: object) -> None:
    x, y = np.asarray(x), np.asarray(y)
    result = found(x, y)
    rho = stats.spearmanr(x, y).statistic
    n = effective_pairs(stats.rankdata(x), stats.rankdata(y))
    assert (result.first, result.second, result.n) == ("CV", "OC", len(x))
    assert [result.rho, result.n_effective] == pytest.approx([rho, n])
    # The distribution of r on n pairs is that of a beta variable of (n - 2) / 2 on -1 to 1.
    half = n / 2 - 1
    assert result.p == pytest.approx(2 * stats.beta.sf(abs(rho), half, half, loc=-1, scale=2))
    assert result.p_holm is None


def test_only_rows_that_have_both_count() -> None:
    x, y = NOISE[0].copy(), NOISE[0].copy()
    x[:100], y[250:] = np.nan, np.inf
    assert (found(x, y).n, found(x, y).rho, found(x, y).p) == (150, 1.0, 0.0)
    assert (found(x, -y).rho, found(x, -y).p) == (-1.0, 0.0)


def test_constant_or_few_values_have_no_correlation() -> None:
    few = np.where(np.arange(300) < 9, NOISE[0], np.nan)
    for x, y in ((NOISE[0], np.ones(300)), (np.ones(300), NOISE[0]), (few, NOISE[1])):
        assert correlate("CV", "OC", x, y) is None


def test_logs_are_combined_by_fishers_z_with_the_variance_of_ranks() -> None:
    """Fieller, Hartley & Pearson (1957): the variance of z is 1.06 / (n - 3)."""
    parts = [
        Correlation("CV", "OC", rho, n, n_effective, p=0.5)
        for rho, n, n_effective in ((0.5, 100, 40.0), (-0.2, 60, 13.0), (0.9, 50, 3.0))
    ]
    result = combine(parts)
    z = (37 * math.atanh(0.5) + 10 * math.atanh(-0.2)) / 47  # three pairs say nothing
    assert (result.n, result.n_effective) == (160, 53.0)
    assert result.rho == pytest.approx(math.tanh(z))
    assert result.p == pytest.approx(math.erfc(z * math.sqrt(47 / 1.06) / math.sqrt(2)))
    mirrored = combine([replace(part, rho=-part.rho) for part in parts])
    assert [mirrored.rho, mirrored.p] == pytest.approx([-result.rho, result.p])
    assert combine(parts[1:]) == parts[1]
    assert combine([parts[2], replace(parts[2], rho=0.1)]) == parts[2]  # nothing to weigh by
    assert combine([replace(parts[0], rho=1.0)] * 2).rho == pytest.approx(1.0)
    for sign in (1, -1):  # one small perfect log is not all
        small, large = replace(parts[0], rho=sign, n_effective=4.0), replace(parts[0], n_effective=100.0)
        mixed = combine([small, replace(large, rho=0.2 * sign)]).rho
        assert sign * mixed == pytest.approx(
            math.tanh((math.atanh(1 - 1e-12) + 97 * math.atanh(0.2)) / 98)
        )
