from collections.abc import Callable

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.metric import METRICS, Kind
from rover_metrics.analysis.statistics.series import Series, rate_per_metre

MakeLog = Callable[..., Log]
NAN = np.nan


def test_a_rate_per_metre_is_the_ratio_of_the_gains_and_needs_a_metre(make_log: MakeLog) -> None:
    """A reset between two rows is no gain, a row that lacks a number gives none."""
    stamps, collisions = [0, 1, 2, 3, 0, 1], [4, 6, 9, NAN, 0, 2]
    for metres, expected in (
        ([10, 11, 12.5, 13, 0, 1], 7 / 3.5),
        ([10, 10.25, 10.5, 11, 0, 0.5], 7.0),  # exactly a metre
        ([10, 10.25, 10.5, 11, 0, 0.4999], None),
        ([10, NAN, 12.5, 13, 0, 1], 5 / 3.5),
    ):
        log = make_log({"Total Collisions": collisions, "Distance Traveled": metres}, stamps)
        assert rate_per_metre(log, METRICS["TC"]) == expected
        assert rate_per_metre(log, METRICS["DT"]) is None
    assert rate_per_metre(make_log({"Total Collisions": [1, 2]}), METRICS["TC"]) is None


def marked(values: list[float], multiplier: float = 1.5, kind: Kind = Kind.LEVEL) -> list[int]:
    series = Series(np.array(values, float), np.ones(len(values)))
    return np.flatnonzero(series.outliers(kind, multiplier)).tolist()


@settings(max_examples=40)
@given(st.lists(st.integers(-20, 20) | st.just(np.nan), max_size=12), st.sampled_from([0.5, 1.5]))
def test_an_outlier_lies_beyond_tukeys_fences(values: list[float], multiplier: float) -> None:
    known = [value for value in values if not np.isnan(value)]
    if not known:
        assert marked(values) == []
        return
    reach, (low, high) = multiplier * stats.iqr(known), np.percentile(known, [25, 75])
    beyond = [i for i, v in enumerate(values) if v > high + reach or v < low - reach]
    assert marked(values, multiplier) == (beyond if reach else [])
    assert [marked([0, 1, 2, 3, 4], multiplier) for multiplier in (0.5, 0.499)] == [[], [0, 4]]
    assert marked([0, 100, 100, 100], 0.001, kind=Kind.FLAG) == []  # a flag has none
