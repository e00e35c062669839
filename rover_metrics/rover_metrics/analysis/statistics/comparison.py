"""Whether two groups of drives differ, judged by one value per drive.

Rows of one log repeat each other: the mean of a log (or of an episode) is one observation. Small groups
are judged by an exact permutation test, which assumes no distribution, large ones by ranks, for rates
and accelerations are skewed; where each observation has its partner in the other group (the same world),
so are the differences within the pairs. Hedges' g of pairs too is by the spread within the groups, so
that both designs compare.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import count
from math import comb, sqrt
from typing import TypeVar

import numpy as np
import scipy  # loads a part of it when that is named

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.statistics.correlation import Correlation
from rover_metrics.analysis.statistics.summary import Interval, t_interval

_ROUNDING = 1 + 1e-9  # 1 - 0.95 is a little more than 0.05
MOST_SPLITS = 20_000  # 8 against 8 is 12870; the signs of 14 pairs are 16384


@dataclass(frozen=True)
class Comparison:
    """How the second group differs from the first in one metric; None where that cannot be said."""

    code: str
    n: tuple[int, int]  # observations of each group
    means: tuple[float | None, float | None]  # of each group's observations
    difference: float | None = None  # second mean minus first
    interval: Interval | None = None  # Welch's, which allows different variances; of pairs Student's
    test: str | None = None
    p: float | None = None  # two-sided probability of a difference this large if there were none
    p_holm: float | None = None  # the same, adjusted for the number of metrics compared
    smallest_p: float | None = None  # the lowest p that groups of these sizes can reach at all
    hedges_g: float | None = None  # standardised difference
    cliffs_delta: float | None = None  # from -1 (all of the second below the first) to 1
    paired: bool = False

    @property
    def effect(self) -> float:
        """Size of the difference whichever its sign, to rank by: |g|, infinite where nothing varies."""
        if self.hedges_g is not None or not self.difference:
            return abs(self.hedges_g or 0.0)
        return math.inf if min(self.n) > 1 else 0.0


def compare(
    code: str, first: Floats, second: Floats, confidence: float, *, paired: bool = False
) -> Comparison:
    """Compares two groups of observations; to test them takes two or more in each.

    Args:
        code: The metric they are of.
        first: Observations of the first group, finite.
        second: Those of the second.
        confidence: Level of the interval, between 0 and 1.
        paired: Whether the i-th of the one belongs to the i-th of the other; else all are independent.
    """
    sizes = (first.size, second.size)
    comparison = Comparison(code, sizes, (_mean(first), _mean(second)), paired=paired)
    if 0 in sizes:
        return comparison
    comparison = replace(
        comparison,
        difference=float(second.mean() - first.mean()),
        cliffs_delta=float(np.sign(np.subtract.outer(second, first)).mean()),
    )
    if min(sizes) < 2:
        return comparison
    if paired:
        differences = second - first
        test, p = _test_pairs(differences)
        interval = t_interval(differences, float(differences.mean()), confidence)
    else:
        test, p = _test(first, second)
        interval = _welch_interval(first, second, confidence)
    d, freedom = cohens_d(first, second), sum(sizes) - 2
    return replace(
        comparison,
        interval=interval,
        test=test,
        p=p,
        smallest_p=smallest_p(*sizes, paired=paired),
        hedges_g=None if d is None else (1 - 3 / (4 * freedom - 1)) * d,  # for small samples
    )


def smallest_p(first: int, second: int, *, paired: bool) -> float:
    """Returns the lowest two-sided p-value that groups can reach at all.

    Args:
        first: Size of one group.
        second: Size of the other; without meaning if paired.
        paired: Whether the test is of pairs (Wilcoxon) instead of groups (Mann-Whitney).
    """
    return min(1.0, 2 / (2**first if paired else comb(first + second, first)))


def _mean(values: Floats) -> float | None:
    return float(values.mean()) if values.size else None


def _test(first: Floats, second: Floats) -> tuple[str, float]:
    """Returns the name of the test that suits the sizes, and its p-value."""
    if comb(first.size + second.size, first.size) > MOST_SPLITS:
        return "Mann-Whitney U", float(scipy.stats.mannwhitneyu(first, second).pvalue)
    result = scipy.stats.permutation_test(
        (first, second),
        lambda a, b, axis: np.mean(b, axis=axis) - np.mean(a, axis=axis),
        n_resamples=MOST_SPLITS,  # so all of them
        vectorized=True,
    )
    return "exact permutation", float(result.pvalue)


def _test_pairs(differences: Floats) -> tuple[str, float]:
    """Returns test and p-value for the differences within pairs, whose mean is 0 if nothing differs."""
    if not differences.any():
        return "exact sign flips", 1.0
    if 2**differences.size > MOST_SPLITS:
        return "Wilcoxon signed-rank", float(scipy.stats.wilcoxon(differences).pvalue)
    result = scipy.stats.permutation_test(
        (differences,), np.mean, permutation_type="samples", n_resamples=MOST_SPLITS, vectorized=True
    )
    return "exact sign flips", float(result.pvalue)


def _welch_interval(first: Floats, second: Floats, confidence: float) -> Interval | None:
    """Returns Welch's interval for second mean minus first; None if neither group varies."""
    a, b = first.var(ddof=1) / first.size, second.var(ddof=1) / second.size
    if a + b == 0:
        return None
    freedom = (a + b) ** 2 / (a**2 / (first.size - 1) + b**2 / (second.size - 1))
    half = float(scipy.stats.t.ppf((1 + confidence) / 2, freedom)) * sqrt(a + b)
    difference = float(second.mean() - first.mean())
    return difference - half, difference + half


def cohens_d(first: Floats, second: Floats) -> float | None:
    """Returns second mean minus first in pooled standard deviations; None where neither group varies."""
    freedom = first.size + second.size - 2
    squares = (first.size - 1) * first.var(ddof=1) + (second.size - 1) * second.var(ddof=1)
    if squares == 0:
        return None
    return float(second.mean() - first.mean()) / sqrt(float(squares) / freedom)


def describe_power(comparisons: Sequence[Comparison], unit: str, alpha: float) -> Iterator[str]:
    """Yields why no metric, or which ones, cannot differ by these tests, however they come out.

    Args:
        comparisons: One per metric.
        unit: What one observation is, in the singular.
        alpha: Below it an adjusted p-value counts as a difference.
    """
    reachable = [each.smallest_p for each in comparisons if each.smallest_p is not None]
    if comparisons and not reachable:
        yield f"No test: it needs two {unit}s or more in each group."
    if not reachable:
        return
    tests, paired = len(reachable), comparisons[0].paired
    lowest, above = min(1.0, tests * min(reachable)), alpha * _ROUNDING
    if lowest > above:
        enough = next(n for n in count(2) if tests * smallest_p(n, n, paired=paired) <= above)
        among = f" among {tests} metrics" if tests > 1 else ""
        fewer = ", or fewer metrics with -m" if tests > 1 else ""
        yield (
            f"So few {unit}s cannot give a p (Holm) below {lowest:.2g}{among}, whatever they show: no "
            f"difference can be told at {alpha:.2g}. It takes {enough} {unit}s in each group{fewer}."
        )
        return
    hopeless = [each.code for each in comparisons if (each.smallest_p or 0.0) > above]
    if hopeless:
        yield f"So few {unit}s cannot give a p below {alpha:.2g} for {', '.join(hopeless)}."


Tested = TypeVar("Tested", Comparison, Correlation)


def holm(probabilities: Sequence[float | None]) -> list[float | None]:
    """Adjusts p-values so that the chance of any false alarm among them stays as stated (Holm 1979).

    None stands where there was no test, which does not count.
    """
    tests = sorted((p, i) for i, p in enumerate(probabilities) if p is not None)
    adjusted: list[float | None] = [None] * len(probabilities)
    highest = 0.0
    for rank, (p, i) in enumerate(tests):
        highest = max(highest, min(1.0, (len(tests) - rank) * p))
        adjusted[i] = highest
    return adjusted


def with_holm(tested: Sequence[Tested]) -> tuple[Tested, ...]:
    """Returns comparisons or correlations with their adjusted p-values."""
    adjusted = holm([each.p for each in tested])
    return tuple(replace(each, p_holm=p) for each, p in zip(tested, adjusted, strict=True))
