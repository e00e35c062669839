"""Bounds against hand-made series, and against what Python's own statistics say of random ones."""

import math
import statistics

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from harness.scenario.bound import Bound
from harness.scenario.judge import judge, judge_against, value_of
from harness.scenario.series import Series

NAN, INF = math.nan, math.inf
FLOATS = st.floats(-10.0, 10.0)


def series(*values: float, unit: str = "m") -> Series:
    """A value a second, from 1 s on."""
    return Series(np.arange(1.0, len(values) + 1.0), np.array(values), unit)


@pytest.mark.parametrize(
    ("bound", "values", "told"),
    [
        (Bound(max=2, window=(2, 9)), (9, NAN, 3, 2.5, 4), "q: 4 m > 2 m at 5 s, first at 3 s"),
        (Bound(min=2), (3, 1, 0.5), "q: 0.5 m < 2 m at 3 s, first at 2 s"),
        (Bound(min=2, max=4), (3, 5, 1, 1), "q: 1 m < 2 m, first at 3 s"),
        (Bound(min=2, max=4), (5, 1), "q: 1 m < 2 m, first at 2 s"),
        (Bound(max=2, over="end"), (9, 9, 3.14159), "q: at the end 3.142 m > 2 m"),
        (Bound(max=2, over="mean", window=(1, 2)), (2, 3, 0), "q: mean 2.5 m > 2 m between 1 and 2 s"),
        (Bound(min=2, over="p95"), (0, 0, 1), "q: 95th percentile 1 m < 2 m"),
        (
            *(Bound(max=2, over="share", share=0.75), (1, 2, 3, 4)),
            "q: 50 % of values below 2 m, 75 % expected",
        ),
        (
            *(Bound(min=2, max=3, over="share", share=1, window=(1, 4)), (1, 2, 3, 4)),
            "q: 50 % of values within 2 to 3 m, 100 % expected between 1 and 4 s",
        ),
        (Bound(min=5, over="share", share=1), (1,), "q: 0 % of values above 5 m, 100 % expected"),
        (Bound(max=2), (NAN, 1, NAN), None),
        (Bound(max=2), (NAN, NAN), "q: there is no value"),
        (Bound(max=2, window=(7, 8)), (1,), "q: there is no value between 7 and 8 s"),
        (Bound(max=2, over="p95"), (1, *[INF] * 9), "q: 95th percentile inf m > 2 m"),
        (Bound(max=2, over="mean"), (INF, -INF), "q: mean nan m > 2 m"),
        (Bound(max=1), (1.00000123,), "q: 1.000001 m > 1 m, first at 1 s"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value:RuntimeWarning")
def test_a_breach_is_told_in_a_line_with_the_worst_value(
    bound: Bound, values: tuple[float, ...], told: str | None
) -> None:
    breach = judge("q", bound, series(*values))
    assert (breach and breach.reason) == told


@pytest.mark.parametrize(
    ("bound", "values", "expected"),
    [
        (Bound(max=2), (1, 3, 2.5), 3),
        (Bound(min=2), (3, 1, 2.5), 1),
        (Bound(min=0, max=10), (3, 6, 4), 3),
        (Bound(min=0, max=10), (5, 8, 4), 8),
        (Bound(min=0, max=10), (-1, 12), 12),
        (Bound(min=0, max=10), (-3, 12), -3),
        (Bound(min=2, max=3, over="share", share=0.9), (1, 2, NAN, 3, 9), 0.5),
        (Bound(max=2), (NAN,), None),
        (Bound(max=2), (1, INF), None),
    ],
)
def test_the_value_of_a_run_is_the_one_that_its_bound_is_about(
    bound: Bound, values: tuple[float, ...], expected: float | None
) -> None:
    assert value_of(bound, series(*values)) == expected


@pytest.mark.parametrize(
    ("bound", "told"),
    [
        (Bound(min=3, max=3), None),
        (Bound(min=4), "q: 3 < 4"),
        (Bound(max=1.5), "q: 3 > 1.5, first at 2 s"),
        (Bound(max=2), "q: 3 > 2, first at 3 s"),
        (Bound(max=-1), "q: 3 > -1, first at 1 s"),
        (Bound(min=3, window=(2, 9)), "q: 2 < 3 between 2 and 9 s"),
        (Bound(max=0, window=(2, 9)), "q: 2 > 0, first at 2 s"),
        (Bound(min=1, window=(5, 9)), "q: 0 < 1 between 5 and 9 s"),
    ],
)
def test_of_a_tally_the_number_of_values_is_judged(bound: Bound, told: str | None) -> None:
    tally = Series(np.array([1.0, 2.0, 3.0]), np.ones(3), is_tally=True)
    breach = judge("q", bound, tally)
    assert (breach and breach.reason) == told
    assert value_of(Bound(over="end", absolute=1, window=(2, 9)), tally) == 2.0


@settings(max_examples=40)
@example([0.0, 1.0, 1.0, 1.0, 1.0], 0.0, 0.0)
@given(st.lists(FLOATS, min_size=1, max_size=25), FLOATS, st.floats(0.0, 5.0))
def test_a_bound_is_broken_just_where_plain_python_says_so(
    values: list[float], low: float, width: float
) -> None:
    high, what = low + width, series(*values)

    def is_kept(value: float) -> bool:
        return low <= value <= high

    ordered = sorted(values)
    of_one = {
        "end": values[-1],
        "mean": statistics.fmean(values),
        "p95": ordered[math.ceil(0.95 * len(values)) - 1],
    }
    for over, value in of_one.items():
        bound = Bound(min=low, max=high, over=over)  # type: ignore[arg-type]  # of a literal
        found = value_of(bound, what)
        assert found == pytest.approx(value, abs=1e-12)
        assert (judge("q", bound, what) is None) == is_kept(found if found is not None else NAN)
    always = judge("q", Bound(min=low, max=high), what)
    broken = [n for n, value in enumerate(values, 1) if not is_kept(value)]
    assert (always is None) == (not broken)
    below = [n for n, value in enumerate(values, 1) if value < low]
    assert always is None or always.time_s == (below or broken)[0]
    share = sum(map(is_kept, values)) / len(values)
    for asked in (share, share + 0.01):
        if 0.0 < asked <= 1.0:
            judged = judge("q", Bound(min=low, max=high, over="share", share=asked), what)
            assert (judged is None) == (asked == share)


@pytest.mark.parametrize(
    ("tolerance", "value", "baseline", "told"),
    [
        ({"relative": 0.1}, -2.15, -2.0, None),
        ({"relative": 0.1}, 1.2, 1.0, "q: at the end 1.2 m, baseline 1 m, allowed +- 0.1 m"),
        ({"absolute": 0.5}, 1.5, 1.0, None),
        ({"absolute": 0.5}, 1.6, 1.0, "q: at the end 1.6 m, baseline 1 m, allowed +- 0.5 m"),
        ({"absolute": 0.5, "relative": 1.0}, 1.9, 1.0, None),
        (
            *({"absolute": 0.1, "relative": 0.1}, -1.15, -1.0),
            "q: at the end -1.15 m, baseline -1 m, allowed +- 0.1 m",
        ),
        ({"absolute": 0.0}, 1.00001, 1.0, "q: at the end 1.00001 m, baseline 1 m, allowed +- 0 m"),
        ({"relative": 0.1}, NAN, None, None),
        ({"relative": 0.1}, NAN, 1.0, "q: at the end no value, baseline 1 m"),
        ({"relative": 0.1}, 1.0, None, "q: at the end 1 m, baseline no value"),
        ({"relative": 0.1}, INF, 1.0, "q: at the end no value, baseline 1 m"),
    ],
)
def test_a_value_is_near_its_baseline_or_both_are_told(
    tolerance: dict[str, float], value: float, baseline: float | None, told: str | None
) -> None:
    bound = Bound(over="end", **tolerance)  # type: ignore[arg-type]  # of several fields
    breach = judge_against("q", bound, series(5.0, value), baseline)
    if math.isnan(value):  # the last value that is one counts
        breach = judge_against("q", bound, series(value), baseline)
    assert (breach and breach.reason) == told
