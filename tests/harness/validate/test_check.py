import math

from harness.validate.check import Check, Span, around, at_most


def check(measured: float, expected: Span) -> Check:
    return Check("speed", "m/s", expected, measured)


def test_a_value_passes_on_the_ends_of_its_span_and_between() -> None:
    span = Span(0.49, 0.50, "")
    assert [check(value, span).passed for value in (0.489, 0.49, 0.495, 0.50, 0.501)] == [
        False,
        True,
        True,
        True,
        False,
    ]


def test_nan_never_passes_but_where_nothing_is_expected() -> None:
    assert not check(math.nan, Span(-math.inf, 1e9, "")).passed
    assert check(math.nan, Span(-math.inf, math.inf, "")).passed
    assert Span(-math.inf, math.inf, "").describe(2) == "-"


def test_open_spans_bound_one_side_only() -> None:
    assert check(1e9, Span(0.07, math.inf, "")).passed
    assert not check(0.06, Span(0.07, math.inf, "")).passed
    assert not check(0.31, at_most(0.3, "")).passed


def test_spans_are_described_with_the_decimals_asked_for() -> None:
    assert around(0.568, 0.03, "").describe(2) == "0.54 to 0.60"
    assert at_most(0.3, "").describe(1) == "at most 0.3"
    assert Span(0.07, math.inf, "").describe(3) == "at least 0.070"
