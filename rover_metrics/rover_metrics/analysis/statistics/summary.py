"""What one sample of values amounts to: location, spread, and intervals for its mean."""

from dataclasses import dataclass, replace

import numpy as np
import scipy  # loads a part of it when that is named

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.autocorrelation import block_length, effective_size

Interval = tuple[float, float]

RESAMPLES = 2000
_AT_ONCE = 200_000  # blocks that are drawn, which bounds the memory that it takes
SEED = 0  # the same log gives the same interval every time
_MOST_BLOCKS = 5000  # more say no more, and longer blocks than the best are no less valid
_FEWEST_FOR_BOOTSTRAP = 20  # rows; below, blocks are too few to resample


@dataclass(frozen=True)
class Summary:
    """A sample in numbers, in the unit of its metric; None where the sample cannot say.

    A flag only has a share: no median, standard deviation, minimum and maximum.
    """

    n: int
    mean: float | None = None  # weighted: of a rate the total over the time, of a flag the share
    n_effective: float | None = None  # independent values that would fix the mean as well
    median: float | None = None
    sd: float | None = None  # n - 1 in the denominator
    minimum: float | None = None
    maximum: float | None = None
    interval: Interval | None = None  # as if values were independent: Student's t, of a flag Wilson's
    bootstrap_interval: Interval | None = None  # of circular blocks, which keep the autocorrelation
    block_length: int | None = None  # rows per block of that bootstrap


def summarise(values: Floats, weights: Floats, kind: Kind, confidence: float) -> Summary:
    """Sums up the rows of one log.

    Args:
        values: Finite, in the order of time; for a flag 0 or 100.
        weights: Positive, as many.
        kind: A flag is summed up by its share alone.
        confidence: Level of the intervals, between 0 and 1.
    """
    if not values.size:
        return Summary(0)
    mean = float(np.average(values, weights=weights))
    summary = Summary(values.size, mean, effective_size(values))
    if values.size >= _FEWEST_FOR_BOOTSTRAP and np.ptp(values):
        length = max(block_length(values), -(-values.size // _MOST_BLOCKS))
        bootstrap = block_bootstrap_interval(values, weights, length, confidence)
        summary = replace(summary, bootstrap_interval=bootstrap, block_length=length)
    if kind is not Kind.FLAG:
        return _with_spread(summary, values, t_interval(values, mean, confidence))
    low, high = wilson(round(mean / 100 * values.size), values.size, confidence)
    return replace(summary, interval=(100 * low, 100 * high))


def wilson(ones: int, count: int, confidence: float) -> Interval:
    """Returns the interval of a share by Wilson's method: never a point, never beyond 0 to 1.

    Args:
        ones: How many there are of what is counted.
        count: Of how many, at least 1.
        confidence: Level of the interval, between 0 and 1.
    """
    interval = scipy.stats.binomtest(ones, count).proportion_ci(confidence, method="wilson")
    return float(interval.low), float(interval.high)


def summarise_independent(values: Floats, kind: Kind, confidence: float) -> Summary:
    """Sums up independent values, such as the means of several logs.

    Args:
        values: Finite.
        kind: No share of a flag lies beyond 0 to 100.
        confidence: Level of the interval, between 0 and 1.
    """
    if not values.size:
        return Summary(0)
    mean = float(values.mean())
    interval = t_interval(values, mean, confidence)
    if kind is Kind.FLAG and interval is not None:
        interval = max(interval[0], 0.0), min(interval[1], 100.0)
    return _with_spread(Summary(values.size, mean, float(values.size)), values, interval)


def _with_spread(summary: Summary, values: Floats, interval: Interval | None) -> Summary:
    return replace(
        summary,
        median=float(np.median(values)),
        sd=float(values.std(ddof=1)) if values.size > 1 else None,
        minimum=float(values.min()),
        maximum=float(values.max()),
        interval=interval,
    )


def t_interval(values: Floats, mean: float, confidence: float) -> Interval | None:
    """Returns Student's interval for a mean; None for fewer than two values or constant ones.

    Args:
        values: Finite.
        mean: Where the interval lies; with weights not the mean of the values.
        confidence: Level, between 0 and 1.
    """
    if values.size < 2 or np.ptp(values) == 0:
        return None
    half = float(scipy.stats.t.ppf((1 + confidence) / 2, values.size - 1) * scipy.stats.sem(values))
    return mean - half, mean + half


def block_bootstrap_interval(
    values: Floats, weights: Floats, length: int, confidence: float
) -> Interval:
    """Returns the percentile interval of the weighted mean over circular blocks (Politis & Romano 1992).

    Sums of blocks come from one cumulative sum, so the cost is that of drawing the blocks.

    Args:
        values: In the order of time.
        weights: As many.
        length: Rows per block.
        confidence: Level of the interval, between 0 and 1.
    """
    rng = np.random.default_rng(SEED)
    n = values.size
    weighted, weight = _block_sums(values * weights, length), _block_sums(weights, length)
    count = -(-n // length)
    means = np.empty(RESAMPLES)
    for some in np.array_split(means, -(-RESAMPLES * count // _AT_ONCE)):
        blocks = rng.integers(n, size=(len(some), count))
        some[:] = weighted[blocks].sum(axis=1) / weight[blocks].sum(axis=1)
    low, high = np.quantile(means, [(1 - confidence) / 2, (1 + confidence) / 2])
    return float(low), float(high)


def _block_sums(values: Floats, length: int) -> Floats:
    """Returns the sum of each run of `length` values, round the end to the beginning."""
    sums = np.concatenate(([0.0], np.cumsum(np.concatenate((values, values[: length - 1])))))
    return sums[length:] - sums[: len(values)]
