"""Which metrics rise and fall together, and how sure that is of rows that repeat each other.

Spearman's rank correlation, because accelerations have single values of forty times the median. Its
p-value is from Student's t with the effective number of pairs (autocorrelation.effective_pairs)
in place of n. Several logs are combined within logs, by Fisher's z weighted with the effective size, so
that a difference between two logs is not taken for a correlation.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy  # loads a part of it when that is named

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.statistics.autocorrelation import effective_pairs

_FEWEST_PAIRS = 10
_RANK_VARIANCE = 1.06  # of Fisher's z of a Spearman correlation, times n - 3 (Fieller et al. 1957)


@dataclass(frozen=True)
class Correlation:
    """The correlation of two metrics."""

    first: str  # code of one metric
    second: str  # code of the other
    rho: float  # Spearman's rank correlation, -1 to 1
    n: int  # rows in which both have a value
    n_effective: float  # independent pairs that would say as much
    p: float  # chance of a correlation at least this strong if there were none
    p_holm: float | None = None  # the same, adjusted for the number of pairs of metrics looked at


def correlate(first: str, second: str, x: Floats, y: Floats) -> Correlation | None:
    """Returns the correlation of two metrics of one log.

    None if fewer than ten rows have both or one of them is constant there.

    Args:
        first: Code of x.
        second: Code of y.
        x: One value per row, NaN for none.
        y: As many.
    """
    both = np.flatnonzero(np.isfinite(x) & np.isfinite(y))
    if both.size < _FEWEST_PAIRS or np.ptp(x[both]) == 0 or np.ptp(y[both]) == 0:
        return None
    x_ranks, y_ranks = scipy.stats.rankdata(x[both]), scipy.stats.rankdata(y[both])
    rho = float(np.clip(np.corrcoef(x_ranks, y_ranks)[0, 1], -1, 1))
    n = effective_pairs(x_ranks, y_ranks)
    t = abs(rho) * np.sqrt((n - 2) / (1 - rho**2)) if abs(rho) < 1 else np.inf
    return Correlation(first, second, rho, both.size, n, p=2 * float(scipy.stats.t.sf(t, n - 2)))


def combine(parts: Sequence[Correlation]) -> Correlation:
    """Returns the correlation of two metrics over several logs, from that of each, at least one."""
    telling = [part for part in parts if part.n_effective > 3] or list(parts[:1])
    if len(telling) == 1:
        return telling[0]
    weights = np.array([part.n_effective - 3 for part in telling])
    z = np.arctanh(np.clip([part.rho for part in telling], -1 + 1e-12, 1 - 1e-12))
    mean = float(np.average(z, weights=weights))
    p = 2 * float(scipy.stats.norm.sf(abs(mean) * np.sqrt(weights.sum() / _RANK_VARIANCE)))
    return Correlation(
        first=telling[0].first,
        second=telling[0].second,
        rho=float(np.tanh(mean)),
        n=sum(part.n for part in telling),
        n_effective=sum(part.n_effective for part in telling),
        p=p,
    )
