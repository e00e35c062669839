"""Several tests at once: p-values adjusted so that one false alarm among all stays rare (Holm 1979)."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

from rover_metrics.analysis.statistics.comparison import Comparison
from rover_metrics.analysis.statistics.correlation import Correlation

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
