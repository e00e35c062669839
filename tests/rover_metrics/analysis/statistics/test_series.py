from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.logs.reading import episode_starts
from rover_metrics.analysis.metric import METRICS, Kind
from rover_metrics.analysis.statistics.series import (
    Series,
    metric_series,
    rate_per_metre,
)

MakeLog = Callable[..., Log]
NAN = np.nan


@pytest.mark.parametrize(
    ("counter", "stamps", "rates", "mean"),
    [
        ([5, 6, 6, 10], [0, 1, 2, 6], [NAN, 60, 0, 60], 5 / 6 * 60),  # the total over the time
        ([0, NAN, 4, 5], [0, 1, 2, 3], [NAN, NAN, 120, 60], 5 / 3 * 60),  # a gain is over what passed
        ([0, 1, 0, 3], [10, 11, 0, 1], [NAN, 60, NAN, 180], 120),  # no rate reaches over a reset
    ],
)
def test_a_counter_becomes_a_rate_per_minute_and_its_mean_the_total_over_the_time(
    make_log: MakeLog, counter: list[float], stamps: list[float], rates: list[float], mean: float
) -> None:
    series = metric_series(make_log({"Distance Traveled": counter}, stamps), METRICS["DT"])
    np.testing.assert_allclose(series.values, rates)
    assert series.mean() == pytest.approx(mean)


def test_a_mean_is_weighted_and_of_the_rows_asked_for() -> None:
    series = Series(np.array([60.0, NAN, 0.0, 30.0]), np.array([1.0, 50.0, 2.0, 3.0]))
    assert series.mean() == pytest.approx((60 + 90) / 6)
    assert series.mean(slice(2, 4)) == pytest.approx(90 / 5)
    assert np.isnan(series.mean(slice(1, 2)))
    left = series.without(np.array([True, False, False, False]))
    np.testing.assert_array_equal(left.values, [NAN, NAN, 0.0, 30.0])
    assert [list(part) for part in left.finite()] == [[0.0, 30.0], [2.0, 3.0]]


def test_vort_is_of_rough_rows_unless_an_extended_log_says_it(
    make_log: MakeLog,
) -> None:
    columns = {"Current Velocity": [1, 2, 3, 6], "Is Rough Terrain": [0, 1, NAN, 1]}
    log, own = make_log(columns), make_log({**columns, "VORT [m/s]": [0.5, NAN, 0.3, NAN]})
    assert metric_series(log, METRICS["VORT"]).finite()[0].tolist() == [2.0, 6.0]
    assert metric_series(log, METRICS["CV"]).mean() == pytest.approx(3.0)
    assert metric_series(own, METRICS["VORT"]).finite()[0].tolist() == [0.5, 0.3]
    lacking = ({"Current Velocity": [1]}, {"Is Rough Terrain": [1]}, {"VORT [m/s]": [1]})
    assert [make_log(each).has(METRICS["VORT"]) for each in lacking] == [False, False, True]


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


def test_episodes_begin_at_resets_gaps_and_falling_counters() -> None:
    for stamps, counter, starts in (
        ([1, 2, 1, 2], [0, 1, 2, 3], [0, 2]),
        ([1, 2, 12, 22.001, 22.001], [0, 1, 2, 3, 3], [0, 3]),
        ([1, 2, 3, 4], [5, NAN, 2, 3], [0, 2]),
        ([1], [0], [0]),
    ):
        assert list(episode_starts(np.array(stamps, float), [np.array(counter, float)])) == starts


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
