"""When a tuned value replaces the default, and when it is proven to be better."""

import pytest

from harness.tune.episodes.plan import Part
from harness.tune.scoring.choose import Candidate, Verdict
from harness.tune.scoring.estimate import Estimate


def candidate(value: float, score: Estimate) -> Candidate:
    other = Estimate(0.1, 0.0, 0.2)  # the part on which it was chosen says nothing
    scores = {
        Part.TRAIN: {"F1": other, "recall": other},
        Part.TEST: {"F1": score, "recall": other},
    }
    return Candidate(value=value, scores=scores)


def verdict(gain: Estimate, tuned: Estimate, default: Estimate) -> Verdict:
    return Verdict(
        name="collision_threshold",
        unit="m",
        measure="F1",
        default=candidate(0.2, default),
        tuned=candidate(0.3, tuned),
        gain={"F1": gain, "recall": Estimate(0.5, 0.4, 0.6)},
    )


SOME = Estimate(0.5, 0.4, 0.6)


@pytest.mark.parametrize(
    ("low", "value"),
    [(0.001, 0.3), (0.0006, 0.3), (0.0004, None), (0.0, None), (-0.001, None), (None, None)],
)
def test_a_value_is_given_only_if_the_whole_interval_of_its_gain_is_above_zero(
    low: float | None, value: float | None
) -> None:
    assert verdict(Estimate(0.1, low, 0.2), SOME, SOME).value == value


@pytest.mark.parametrize(
    ("tuned_low", "default_high", "proven"),
    [(0.61, 0.6, True), (0.6, 0.6, False), (0.59, 0.6, False), (None, 0.6, False), (0.61, None, False)],
)
def test_it_is_proven_only_if_the_intervals_are_apart(
    tuned_low: float | None, default_high: float | None, *, proven: bool
) -> None:
    tuned, default = Estimate(0.7, tuned_low, 0.8), Estimate(0.5, 0.4, default_high)

    assert verdict(SOME, tuned, default).is_proven is proven
    assert not verdict(SOME, default, tuned).is_proven


@pytest.mark.parametrize(
    ("gain", "digits"),
    [
        (Estimate(0.2, 0.1, 0.3), 2),
        (Estimate(0.01, 0.01, 0.01), 2),
        (Estimate(0.0086, 0.0068, 0.0108), 3),  # 0.987 to 0.996, not 0.99 to 1.00
        (Estimate(0.02, 0.0002, 0.04), 3),
        (Estimate(0.005, -0.02, 0.03), 3),
        (Estimate(-0.02, -0.04, -0.0099), 3),
        (Estimate(0.0, -0.1, 0.1), 2),  # what is 0 is told as 0
        (Estimate(0.02), 2),
        (Estimate(float("nan")), 2),
    ],
)
def test_scores_have_a_third_digit_where_two_hide_the_difference(gain: Estimate, digits: int) -> None:
    assert verdict(gain, SOME, SOME).digits == digits


def test_a_value_is_told_as_it_is_written() -> None:
    some = verdict(SOME, SOME, SOME)
    assert some.written(candidate(0.250, SOME)) == "0.25 m"
    assert [some.written(candidate(value, SOME)) for value in (True, False)] == ["true", "false"]
