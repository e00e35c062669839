"""Whether so few observations can show a difference at all, said beside their comparison."""

from collections.abc import Iterator, Sequence
from itertools import count

from rover_metrics.analysis.statistics.comparison import Comparison, smallest_p

_ROUNDING = 1 + 1e-9  # 1 - 0.95 is a little more than 0.05


def describe_power(comparisons: Sequence[Comparison], unit: str, alpha: float) -> Iterator[str]:
    """Yields why no metric, or which ones, cannot differ by these tests, however they come out.

    A difference counts if its adjusted p-value is below alpha; `unit` is what one observation is.
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
