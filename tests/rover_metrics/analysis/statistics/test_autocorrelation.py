"""What repetition leaves of a sample: the sums of the cited papers, written out lag by lag."""

import math

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.statistics.autocorrelation import (
    autocorrelation,
    block_length,
    effective_pairs,
    effective_size,
)


def autoregressive(phi: float, n: int, seed: int = 0) -> Floats:
    """x[i] = phi x[i - 1] + noise."""
    noise = np.random.default_rng(seed).normal(size=n)
    values = np.empty(n)
    values[0] = noise[0] / np.sqrt(1 - phi**2)
    for i in range(1, n):
        values[i] = phi * values[i - 1] + noise[i]
    return values


def rho(values: Floats, lag: int) -> float:
    """The biased estimate by its definition."""
    centred = values - values.mean()
    return float(centred[: len(values) - lag] @ centred[lag:]) / float(centred @ centred)


def geyer(values: Floats) -> float:
    """Geyer (1992), 3.3: pairs of lags are summed while they are positive."""
    n, total = len(values), 0.0
    for lag in range(1, n // 2, 2):
        pair = rho(values, lag) + rho(values, lag + 1)
        if pair <= 0:
            break
        total += pair
    return min(max(n / (1 + 2 * total), 1.0), n)


def pyper_peterman(x: Floats, y: Floats) -> float:
    """Pyper & Peterman (1998), eq. 1: 1 / N* = 1 / N + 2 / N sum of (N - j) / N rxx(j) ryy(j)."""
    n = len(x)
    inverse = 1 / n + 2 / n * sum((n - j) / n * rho(x, j) * rho(y, j) for j in range(1, n // 5 + 1))
    return min(max(1 / inverse if inverse > 0 else math.inf, 3.0), n)


def politis_white(values: Floats) -> int:
    """Politis & White (2004), 3.2 and 3.3, with D of the correction (2009) for circular blocks."""
    n = len(values)
    limit, quiet = 2 * math.sqrt(math.log10(n) / n), max(5, int(math.sqrt(math.log10(n))))
    top = min(math.ceil(math.sqrt(n)) + quiet, n - 1)
    loud = [lag for lag in range(1, top + 1) if abs(rho(values, lag)) > limit]
    starts = (m for m in range(top - quiet + 1) if not any(m < lag <= m + quiet for lag in loud))
    m_hat = next(starts, loud[-1] if loud else 0)
    m = min(2 * max(m_hat, 1), top)
    g = slope = 0.0
    for k in range(-m, m + 1):
        weight = min(1.0, 2 * (1 - abs(k) / m))
        g += weight * rho(values, abs(k))
        slope += weight * abs(k) * rho(values, abs(k))
    longest = min(3 * math.sqrt(n), n / 3)
    best = (2 * slope**2 / (4 / 3 * g**2)) ** (1 / 3) * n ** (1 / 3) if g > 0 else longest
    return max(1, math.ceil(min(best, longest)))


SERIES = [
    autoregressive(phi, n, seed=n) for n in (4, 5, 11, 20, 21, 60, 301) for phi in (-0.9, 0.0, 0.5, 0.95)
] + [
    np.arange(30.0),
    np.tile([0.0, 1.0], 5),
    np.random.default_rng(5).normal(size=60).cumsum(),  # significant up to the longest lag
    np.array([0.0, 0.0, 3.0, 2.0, 1.0, 3.0, 1.0, 3.0, 3.0, 3.0]),  # every pair is positive, up to n / 2
    np.tile([3.0] + [0.0] * 9, 12) + np.random.default_rng(4).normal(0, 0.1, 120),  # quiet, then loud
    # Significant lags five apart, which four quiet ones part.
    np.random.default_rng(3).normal(size=40) + 1.5 * np.cos(math.tau / 5 * np.arange(40)),
]


def test_autocorrelation_is_that_of_its_definition(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    values = autoregressive(0.7, 500)
    direct = [rho(values, lag) for lag in range(500)]
    np.testing.assert_allclose(autocorrelation(values, 499), direct, atol=1e-12)
    monkeypatch.setattr("rover_metrics.analysis.statistics.autocorrelation._SEGMENT", 100)
    np.testing.assert_allclose(autocorrelation(values, 5), direct[:6], atol=0.05)
    # Within segments only, all of them, by the variance of the whole.
    parts = (values - values.mean()).reshape(5, 100)
    lag_3 = sum(float(part[:-3] @ part[3:]) for part in parts) / float((parts**2).sum())
    assert autocorrelation(values, 5)[3] == pytest.approx(lag_3)


@pytest.mark.parametrize("values", SERIES, ids=lambda values: str(len(values)))
def test_sizes_and_blocks_are_those_of_the_papers(values: Floats) -> None:
    other = autoregressive(0.8, len(values), seed=1)
    assert effective_size(values) == pytest.approx(geyer(values))
    for second in (other, values):
        pairs = pyper_peterman(values, second) if len(values) >= 5 else len(values)
        assert effective_pairs(values, second) == pytest.approx(pairs)
    assert block_length(values) == politis_white(values)


def test_constant_and_few_values_repeat_nothing() -> None:
    assert autocorrelation(np.full(9, 3.3), 4).tolist() == [1, 0, 0, 0, 0]
    assert effective_size(np.full(9, 3.3)) == 9
    assert [effective_size(np.arange(float(n))) for n in (1, 2, 3)] == [1, 2, 3]
    assert effective_pairs(np.arange(2.0), np.arange(2.0)) == 2
