"""Which value of a threshold is chosen, how it is judged beside the default, when it replaces it."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.tune.episodes.plan import Part
from harness.tune.episodes.record import EpisodeRecord
from harness.tune.scoring.choose import Candidate, Scoring, Verdict, judged
from harness.tune.scoring.estimate import Estimate, Sums
from rover_metrics.core.thresholds import THRESHOLD_INFO

MakeRecord = Callable[..., EpisodeRecord]

PARAMETER = "collision_threshold"
DEFAULT = THRESHOLD_INFO[PARAMETER].default
GRID = np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
NAN = float("nan")


def mean(sums: Sums) -> NDArray[np.float64]:
    return np.asarray(sums[..., 0] / sums[..., 1])


def scoring(scores: Sequence[float]) -> Scoring:
    """One in which a value of the grid has this score in an episode, plus the episode's own path."""
    table = dict(zip(GRID.tolist(), scores, strict=True))

    def count(records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]) -> NDArray[np.float64]:
        rows = [[(table[t] + r.path_length, 1.0) for r in records] for t in thresholds.tolist()]
        return np.array(rows)

    measures = {"doubled": lambda sums: 2 * mean(sums), "mean": mean}
    return Scoring(count, measures, "mean", GRID)


@pytest.fixture
def episodes(make_record: MakeRecord) -> list[EpisodeRecord]:
    """Ten of 0.05 to 0.5 m by two drivers on two terrains."""
    return [
        make_record([3.0] * n, driver=("ram", "roam")[n % 2], terrain=("flat", "maze")[n % 3 == 0])
        for n in range(1, 11)
    ]


@pytest.mark.parametrize(
    ("scores", "best"),
    [
        ((0.0, 1.0, 3.0, 2.999, 2.999, 0.0), 0.3),
        ((1.0, 1.0, 1.0, 1.0, 1.0, 0.0), 0.3),  # the middle of a plateau
        ((0.0, 2.0, 2.0, 0.0, 0.0, 0.0), 0.3),  # of an even number the upper of the middle two
        ((2.0, 0.0, 0.0, 0.0, 2.0, 2.0), 0.5),  # of plateaus apart likewise
        ((NAN, 1.0, 2.0, NAN, 0.0, NAN), 0.3),  # what is undefined is not best
    ],
)
def test_the_best_value_is_the_middle_of_those_with_the_highest_score(
    episodes: list[EpisodeRecord], scores: tuple[float, ...], best: float
) -> None:
    assert scoring(scores).best(episodes) == best


def test_the_gain_is_of_the_same_resampled_episodes(
    episodes: list[EpisodeRecord],
) -> None:
    gain = scoring((0.0, 1.0, 2.0, 3.5, 4.0, 5.0)).gain(episodes, (0.4, 0.2))
    for name, expected in (("mean", 2.5), ("doubled", 5.0)):  # every episode gains as much
        assert (gain[name].value, gain[name].low, gain[name].high) == pytest.approx((expected,) * 3)


def test_a_value_is_chosen_on_one_part_and_judged_on_the_other(
    episodes: list[EpisodeRecord],
) -> None:
    one, other = scoring((0.0, 1.0, 2.0, 0.0, 0.0, 0.0)), scoring((0.0, 3.0, 0.0, 0.0, 9.0, 0.0))

    def count(records: Sequence[EpisodeRecord], thresholds: NDArray[np.float64]) -> NDArray[np.float64]:
        return (one if len(records) < 9 else other).count(records, thresholds)

    some = {Part.TRAIN: episodes[:8], Part.TEST: episodes}
    judge = partial(judged, PARAMETER, Scoring(count, one.measures, "mean", GRID), some, lack=None)
    verdict = judge(note="a note")
    assert (verdict.name, verdict.unit, verdict.measure) == (PARAMETER, "m", "mean")
    assert (verdict.note, verdict.lack) == ("a note", None)
    assert verdict.default.value == DEFAULT == 0.2
    assert verdict.tuned is not None
    assert verdict.tuned.value == 0.3  # best of the training half
    assert verdict.gain["mean"].value == pytest.approx(-3.0)  # but worse on the test half
    assert verdict.value is None
    told = judge(value=0.5)  # found by other means
    assert [told.value, told.gain["mean"].value] == pytest.approx([0.5, 6.0])


def test_without_support_only_the_default_is_scored(episodes: list[EpisodeRecord]) -> None:
    some = dict.fromkeys(Part, episodes)
    verdict = judged(PARAMETER, scoring((0.0, 1.0, 2.0, 0.0, 0.0, 0.0)), some, lack="too few", value=0.3)
    assert (verdict.tuned, verdict.value, verdict.lack) == (None, None, "too few")
    assert (verdict.name, verdict.unit, verdict.measure) == (PARAMETER, "m", "mean")
    assert verdict.default.scores[Part.TEST]["mean"].value == pytest.approx(1.275)
    assert not verdict.is_proven


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


def test_a_value_is_given_only_if_the_whole_interval_of_its_gain_is_above_zero() -> None:
    for low, value in ((0.001, 0.3), (0.0006, 0.3), (0.0004, None), (-0.001, None), (None, None)):
        assert verdict(Estimate(0.1, low, 0.2), SOME, SOME).value == value


def test_it_is_proven_only_if_the_intervals_are_apart() -> None:
    ends = ((0.61, 0.6, True), (0.6, 0.6, False), (None, 0.6, False), (0.61, None, False))
    for tuned_low, default_high, proven in ends:
        tuned, default = Estimate(0.7, tuned_low, 0.8), Estimate(0.5, 0.4, default_high)
        assert verdict(SOME, tuned, default).is_proven is proven
        assert not verdict(SOME, default, tuned).is_proven


def test_scores_have_a_third_digit_where_two_hide_the_difference() -> None:
    for gain, digits in (
        (Estimate(0.2, 0.1, 0.3), 2),
        (Estimate(0.01, 0.01, 0.01), 2),
        (Estimate(0.0086, 0.0068, 0.0108), 3),  # 0.987 to 0.996, not 0.99 to 1.00
        (Estimate(0.02, 0.0002, 0.04), 3),
        (Estimate(-0.02, -0.04, -0.0099), 3),
        (Estimate(0.0, -0.1, 0.1), 2),  # what is 0 is told as 0
        (Estimate(float("nan")), 2),
    ):
        assert verdict(gain, SOME, SOME).digits == digits
    written = [verdict(SOME, SOME, SOME).written(candidate(v, SOME)) for v in (0.250, True, False)]
    assert written == ["0.25 m", "true", "false"]
