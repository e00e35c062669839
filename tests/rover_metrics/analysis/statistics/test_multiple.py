"""Holm's adjustment."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.analysis.statistics.comparison import holm


@given(st.lists(st.none() | st.floats(0.0, 1.0), max_size=6))
def test_it_is_the_step_down_of_holm(probabilities: list[float | None]) -> None:
    """1979: p(j) becomes the largest of (m - i + 1) p(i) for all i up to j, and 1 at most."""
    known = sorted(p for p in probabilities if p is not None)
    for p, adjusted in zip(probabilities, holm(probabilities), strict=True):
        if p is None:
            assert adjusted is None
        else:
            steps = [min(1.0, (len(known) - i) * q) for i, q in enumerate(known) if q <= p]
            assert adjusted == pytest.approx(max(steps))


def test_the_textbooks_example() -> None:
    assert holm([0.01, 0.04, None, 0.03, 0.005]) == pytest.approx([0.03, 0.06, None, 0.06, 0.02])
