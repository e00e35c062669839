"""How much consecutive rows repeat each other, and what that leaves of the sample size."""

import numpy as np
import scipy  # loads a part of it when that is named
from numpy.typing import NDArray

from rover_metrics.analysis.logs.log import Floats

_SEGMENT = 1 << 16  # rows; longer series are averaged over segments, which bounds the memory
_LONGEST_LAG = 4096  # rows


def autocorrelation(values: Floats, max_lag: int) -> Floats:
    """Returns the biased estimate at lags 0 to max_lag, which damps far ones.

    All 0 after lag 0 for constant values; these are evenly spaced, finite, and more than max_lag.
    """
    centred = values - values.mean()
    sums = np.zeros(max_lag + 1)
    for start in range(0, len(centred), _SEGMENT):
        segment = centred[start : start + _SEGMENT]
        size = scipy.fft.next_fast_len(len(segment) + max_lag, real=True)
        power = np.abs(scipy.fft.rfft(segment, size)) ** 2
        sums += scipy.fft.irfft(power, size)[: max_lag + 1]
    if np.ptp(values) == 0:
        return np.concatenate(([1.0], np.zeros(max_lag)))
    return np.asarray(sums / sums[0])


def effective_size(values: Floats) -> float:
    """Returns how many independent values would fix the mean as well as these n do.

    n / (1 + 2 sum of autocorrelations), the sum cut where a pair of neighbouring lags is no longer
    positive (Geyer 1992, initial positive sequence); at least 1 and at most n.
    """
    n = len(values)
    if n < 4:
        return float(n)
    rho = autocorrelation(values, min(n // 2, _LONGEST_LAG))
    pairs = rho[1:-1:2] + rho[2::2]
    ended = np.flatnonzero(pairs <= 0)
    total = pairs[: ended[0] if ended.size else None].sum()
    return float(np.clip(n / (1 + 2 * total), 1, n))


def effective_pairs(x: Floats, y: Floats) -> float:
    """Returns how many independent pairs would fix the correlation of x and y as well.

    Pyper & Peterman (1998), eq. 1 with lags up to n / 5: autocorrelation takes away from a
    correlation's certainty only where both series have it. At least 3 and at most n.
    """
    n = len(x)
    max_lag = min(n // 5, _LONGEST_LAG)
    lags = np.arange(1, max_lag + 1)
    products = autocorrelation(x, max_lag)[1:] * autocorrelation(y, max_lag)[1:]
    inflation = 1 + 2 * float(((n - lags) / n * products).sum())
    return float(np.clip(n / max(inflation, 1.0), 3, n))


def block_length(values: Floats) -> int:
    """Returns the rows per block of a circular block bootstrap of the mean, from 1 to a third of all.

    Politis & White (2004) with the correction of Patton, Politis & White (2009): the length that
    minimises the error of the bootstrap variance, estimated with a flat-top lag window.
    """
    n = len(values)
    quiet = max(5, int(np.sqrt(np.log10(n))))  # lags that must all be insignificant
    max_lag = min(int(np.ceil(np.sqrt(n))) + quiet, n - 1)
    rho = autocorrelation(values, max_lag)
    significant = np.abs(rho[1:]) > 2 * np.sqrt(np.log10(n) / n)
    half_width = _first_quiet_run(significant, quiet)
    lags = np.arange(1, min(2 * max(half_width, 1), max_lag) + 1)
    window = np.minimum(1.0, 2 * (1 - lags / lags[-1]))
    spectrum = 1 + 2 * float((window * rho[lags]).sum())
    slope = 2 * float((window * lags * rho[lags]).sum())
    longest = min(3 * np.sqrt(n), n / 3)
    optimum = (1.5 * (slope / spectrum) ** 2 * n) ** (1 / 3) if spectrum > 0 else longest
    return max(1, int(np.ceil(min(optimum, longest))))


def _first_quiet_run(significant: NDArray[np.bool_], length: int) -> int:
    """Returns the last lag before a run of insignificant ones; the last significant lag if none."""
    loud = np.concatenate(([0], np.flatnonzero(significant) + 1, [len(significant) + 1]))
    quiet_after = np.flatnonzero(np.diff(loud) > length)
    return int(loud[quiet_after[0]] if quiet_after.size else loud[-2])
