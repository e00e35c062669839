import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from rover_metrics.analysis.metric import Kind
from rover_metrics.analysis.statistics.outliers import DEFAULT_MULTIPLIER, outliers
from rover_metrics.analysis.statistics.series import Series


def marked(values: list[float], multiplier: float = 1.5, kind: Kind = Kind.LEVEL) -> list[int]:
    series = Series(np.array(values, float), np.ones(len(values)))
    return np.flatnonzero(outliers(series, kind, multiplier)).tolist()


@given(st.lists(st.integers(-20, 20) | st.just(np.nan), max_size=12), st.sampled_from([0.5, 1.5]))
def test_an_outlier_lies_beyond_tukeys_fences(values: list[float], multiplier: float) -> None:
    known = [value for value in values if not np.isnan(value)]
    if not known:
        assert marked(values) == []
        return
    reach, (low, high) = multiplier * stats.iqr(known), np.percentile(known, [25, 75])
    beyond = [i for i, v in enumerate(values) if v > high + reach or v < low - reach]
    assert marked(values, multiplier) == (beyond if reach else [])


@pytest.mark.parametrize(("multiplier", "expected"), [(0.5, []), (0.499, [0, 4])])
def test_a_value_on_the_fence_is_inside(multiplier: float, expected: list[int]) -> None:
    assert marked([0, 1, 2, 3, 4], multiplier) == expected
    assert DEFAULT_MULTIPLIER == 1.5  # Tukey's


def test_neither_flags_nor_rare_events_are_outliers() -> None:
    assert marked([0, 100, 100, 100], 0.001, kind=Kind.FLAG) == []
    assert marked([0, 0, 0, 0, 0, 0, 0, 600], kind=Kind.COUNTER) == []
