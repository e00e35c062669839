"""Numbers with their uncertainty: whole episodes are resampled, for what happens in one hangs together.

Whatever is scored comes down to counts per episode; a measure turns their sums into a number.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

RESAMPLES, LEVEL = 2000, 0.95
FEWEST_EPISODES = 8  # that have what is counted; with fewer, resampling means little
FEWEST_DIGITS, MOST_DIGITS = 2, 3  # of a reported number
TP, FP, FN, TN = range(4)  # of `confusion`
COLLAPSED = "other"  # strata of a single episode, together

Counts = NDArray[np.float64]  # shape (..., episodes, kinds)
Sums = NDArray[np.float64]  # shape (..., kinds)
Measure = Callable[[Sums], NDArray[np.float64]]  # shape (...)


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number, NaN if there was nothing to count, and its 95 % interval.

    Both ends are None if there are too few episodes for one.
    """

    value: float
    low: float | None = None
    high: float | None = None

    def text(self, digits: int = FEWEST_DIGITS) -> str:
        """Returns it as '0.93 (0.88 to 0.97)'."""
        if math.isnan(self.value):
            return "undefined"
        if self.low is None or self.high is None:
            return f"{self.value:.{digits}f} (too few episodes for an interval)"
        return f"{self.value:.{digits}f} ({self.low:.{digits}f} to {self.high:.{digits}f})"


def digits_for(gain: Estimate) -> int:
    """Returns how many digits show a difference and its interval: 3 where 2 would make one of them 0."""
    given = (each for each in (gain.value, gain.low, gain.high) if each is not None)
    return MOST_DIGITS if any(0.0 < abs(each) < 0.01 for each in given) else FEWEST_DIGITS


def estimate(counts: Counts, measure: Measure, strata: Sequence[str]) -> Estimate:
    """Returns a measure over episodes with its percentile bootstrap interval.

    Args:
        counts: Shape (episodes, kinds).
        measure: Of the sums over episodes.
        strata: What kind each episode is of; the plan fixes how many of each there are, so a resample
            keeps that too.
    """
    value = float(measure(counts.sum(axis=0)))
    if np.count_nonzero(counts.any(axis=1)) < FEWEST_EPISODES:
        return Estimate(value)
    resampled = measure(_weights(tuple(strata)) @ counts)
    if np.isnan(resampled).any():
        return Estimate(value)  # resamples without any: too few episodes have it
    tail = (1.0 - LEVEL) / 2.0
    low, high = np.quantile(resampled, (tail, 1.0 - tail))
    return Estimate(value, float(low), float(high))


def ratio(part: NDArray[np.float64], whole: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns part / whole, NaN where there is no whole."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.where(whole > 0, part / whole, np.nan))


def confusion(
    episodes: Sequence[tuple[NDArray[np.float64], NDArray[np.bool_]]], thresholds: NDArray[np.float64]
) -> Counts:
    """Returns true and false positives, false and true negatives, shape (thresholds, episodes, 4).

    Each episode has values, positive below a threshold, and the truth, both of shape (n,).
    """
    counts = np.zeros((len(thresholds), len(episodes), 4))
    for place, (values, truth) in enumerate(episodes):
        says = values < thresholds[:, None]
        each = (says & truth, says & ~truth, ~says & truth, ~says & ~truth)
        counts[:, place] = np.stack(each).sum(axis=-1).T
    return counts


def share(part: int, *whole: int) -> Measure:
    """Returns the measure that divides the sum of a kind by the sum of others."""
    return lambda sums: ratio(sums[..., part], sums[..., whole].sum(axis=-1))


# Of sums of `confusion`: true positives over positives, true negatives over negatives.
recall, specificity = share(TP, TP, FN), share(TN, TN, FP)


@lru_cache(maxsize=8)
def _weights(strata: tuple[str, ...]) -> NDArray[np.float64]:
    """How often each episode is in each resample, shape (RESAMPLES, episodes).

    The rescaled bootstrap for stratified samples of Rao and Wu (1988): of the n episodes of a stratum
    n - 1 are drawn, each with weight n / (n - 1), so that small strata are not taken for certain.
    SciPy's bootstrap, which draws n of n, makes intervals too narrow for strata of three.
    """
    rng = np.random.default_rng(0)  # the interval belongs to the data, not to the sweep's seed
    weights = np.zeros((RESAMPLES, len(strata)))
    for members in _collapsed(strata):
        size = len(members)
        drawn = rng.multinomial(size - 1, np.full(size, 1.0 / size), size=RESAMPLES)
        weights[:, members] = drawn * (size / (size - 1))
    return weights


def _collapsed(strata: tuple[str, ...]) -> list[NDArray[np.intp]]:
    """Indices of the episodes of each stratum; those with one episode are one stratum."""
    labels = np.array(strata)
    names, sizes = np.unique(labels, return_counts=True)
    labels = np.where(np.isin(labels, names[sizes == 1]), COLLAPSED, labels)
    groups = [np.flatnonzero(labels == name) for name in np.unique(labels)]
    sizes = np.array([len(group) for group in groups])
    if 1 in sizes:  # one episode without its like joins the largest
        alone, largest = int(np.argmin(sizes)), int(np.argmax(sizes))
        groups[largest] = np.concatenate((groups[largest], groups[alone]))
        del groups[alone]
    return groups
