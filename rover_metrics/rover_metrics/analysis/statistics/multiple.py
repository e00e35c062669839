"""Probabilities of several tests at once."""

from collections.abc import Sequence


def holm(probabilities: Sequence[float | None]) -> list[float | None]:
    """Adjust p-values so that the chance of any false alarm among them stays as stated (Holm 1979).

    Args:
        probabilities: One a test; None where there was no test, which does not count.
    """
    tests = sorted((p, i) for i, p in enumerate(probabilities) if p is not None)
    adjusted: list[float | None] = [None] * len(probabilities)
    highest = 0.0
    for rank, (p, i) in enumerate(tests):
        highest = max(highest, min(1.0, (len(tests) - rank) * p))
        adjusted[i] = highest
    return adjusted
