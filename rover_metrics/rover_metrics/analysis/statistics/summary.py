"""What one sample of values amounts to: location, spread, and intervals for its mean."""

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.autocorrelation import block_length, effective_size

Interval = tuple[float, float]

RESAMPLES = 2000
SEED = 0  # the same log gives the same interval every time
_MOST_BLOCKS = 5000  # more say no more, and longer blocks than the best are no less valid
_FEWEST_FOR_BOOTSTRAP = 20  # rows; below, blocks are too few to resample


@dataclass(frozen=True)
class Summary:
    """A sample in numbers, in the unit of its metric; None where the sample cannot say.

    Attributes:
        n: Values.
        n_effective: Independent values that would fix the mean as well.
        mean: Weighted mean: of a rate the total over the time, of a flag the share.
        median: Of the values; as sd, minimum and maximum None for a flag, which only has a share.
        sd: Standard deviation of the values, n - 1 in the denominator.
        minimum: Lowest value.
        maximum: Highest value.
        interval: For the mean as if the values were independent: Student's t, for a flag Wilson's.
        bootstrap_interval: For the mean, from a circular block bootstrap, which keeps the
            autocorrelation within blocks.
        block_length: Rows per block of that bootstrap.
    """

    n: int
    mean: float | None = None
    n_effective: float | None = None
    median: float | None = None
    sd: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    interval: Interval | None = None
    bootstrap_interval: Interval | None = None
    block_length: int | None = None


def summarise(values: Floats, weights: Floats, kind: Kind, confidence: float) -> Summary:
    """Sum up the rows of one log.

    Args:
        values: Finite, in the order of time; for a flag 0 or 100.
        weights: Positive, as many.
        kind: A flag is summed up by its share alone.
        confidence: Level of the intervals, between 0 and 1.
    """
    if not values.size:
        return Summary(0)
    length, bootstrap = _bootstrap(values, weights, confidence)
    n_effective = effective_size(values)
    if kind is Kind.FLAG:
        share = float(values.mean())
        interval = wilson_interval(round(share / 100 * values.size), values.size, confidence)
        return Summary(
            values.size, share, n_effective, None, None, None, None, interval, bootstrap, length
        )
    mean = float(np.average(values, weights=weights))
    return _spread(values, mean, n_effective, confidence, bootstrap, length)


def summarise_independent(values: Floats, kind: Kind, confidence: float) -> Summary:
    """Sum up independent values, such as the means of several logs."""
    if not values.size:
        return Summary(0)
    summary = _spread(values, float(values.mean()), float(values.size), confidence, None, None)
    if kind is not Kind.FLAG or summary.interval is None:
        return summary
    low, high = summary.interval
    return replace(summary, interval=(max(low, 0.0), min(high, 100.0)))  # no share is beyond


def _spread(
    values: Floats,
    mean: float,
    n_effective: float,
    confidence: float,
    bootstrap: Interval | None,
    length: int | None,
) -> Summary:
    return Summary(
        n=values.size,
        mean=mean,
        n_effective=n_effective,
        median=float(np.median(values)),
        sd=float(values.std(ddof=1)) if values.size > 1 else None,
        minimum=float(values.min()),
        maximum=float(values.max()),
        interval=t_interval(values, mean, confidence),
        bootstrap_interval=bootstrap,
        block_length=length,
    )


def t_interval(values: Floats, mean: float, confidence: float) -> Interval | None:
    """Give Student's interval for a mean; None for fewer than two values or constant ones."""
    if values.size < 2 or np.ptp(values) == 0:
        return None
    half = float(stats.t.ppf((1 + confidence) / 2, values.size - 1) * stats.sem(values))
    return mean - half, mean + half


def wilson_interval(ones: int, n: int, confidence: float) -> Interval:
    """Give Wilson's interval for a share [%], which stays within 0 to 100 and never is a point."""
    bounds = stats.binomtest(ones, n).proportion_ci(confidence, method="wilson")
    return 100 * float(bounds.low), 100 * float(bounds.high)


def _bootstrap(values: Floats, weights: Floats, confidence: float) -> tuple[int | None, Interval | None]:
    if values.size < _FEWEST_FOR_BOOTSTRAP or np.ptp(values) == 0:
        return None, None
    length = max(block_length(values), -(-values.size // _MOST_BLOCKS))
    return length, block_bootstrap_interval(values, weights, length, confidence)


def block_bootstrap_interval(
    values: Floats, weights: Floats, length: int, confidence: float, resamples: int = RESAMPLES
) -> Interval:
    """Give the percentile interval of the weighted mean over circular blocks (Politis & Romano 1992).

    Sums of blocks come from one cumulative sum, so the cost is that of drawing the blocks.
    """
    rng = np.random.default_rng(SEED)
    n = values.size
    weighted, weight = _block_sums(values * weights, length), _block_sums(weights, length)
    means = np.empty(resamples)
    for i in range(resamples):
        blocks = rng.integers(n, size=-(-n // length))
        means[i] = weighted[blocks].sum() / weight[blocks].sum()
    low, high = np.quantile(means, [(1 - confidence) / 2, (1 + confidence) / 2])
    return float(low), float(high)


def _block_sums(values: Floats, length: int) -> Floats:
    """Sum each run of `length` values, round the end to the beginning."""
    sums = np.concatenate(([0.0], np.cumsum(np.concatenate((values, values[: length - 1])))))
    return sums[length:] - sums[: len(values)]
