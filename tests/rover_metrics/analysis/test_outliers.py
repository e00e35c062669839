import numpy as np
import pytest

from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.outliers import outliers
from rover_metrics.analysis.series import Series


def marked(values: list[float], multiplier: float = 1.5, kind: Kind = Kind.LEVEL) -> list[int]:
    series = Series(np.array(values), np.ones(len(values)))
    return np.flatnonzero(outliers(series, kind, multiplier)).tolist()


@pytest.mark.parametrize(("multiplier", "expected"), [(0.05, [0, 1, 4, 5]), (1.5, [5]), (100.0, [])])
def test_the_multiplier_moves_the_fences(multiplier: float, expected: list[int]) -> None:
    assert marked([1, 2, 3, 4, 5, 100], multiplier) == expected


def test_both_sides_count_and_missing_values_do_not() -> None:
    assert marked([-50, 1, 2, 3, 4, np.nan, 5, 60]) == [0, 7]


def test_neither_flags_nor_rare_events_are_outliers() -> None:
    assert marked([0, 0, 0, 0, 0, 0, 0, 100], kind=Kind.FLAG) == []
    assert marked([0, 0, 0, 0, 0, 0, 0, 600], kind=Kind.COUNTER) == []
