"""Numbers with their uncertainty."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.tuning.estimate import Estimate, estimate, ratio


def share(sums: NDArray[np.float64]) -> NDArray[np.float64]:
    return ratio(sums[..., 0], sums[..., 1])


def counts(rng: np.random.Generator, episodes: int) -> NDArray[np.float64]:
    tries = np.full(episodes, 10.0)
    return np.column_stack([rng.binomial(10, 0.7, size=episodes), tries])


def test_the_interval_covers_the_truth_about_as_often_as_it_says() -> None:
    rng = np.random.default_rng(5)
    strata = ["a"] * 4 + ["b"] * 4 + ["c"] * 4  # small ones, as in a plan

    estimates = [estimate(counts(rng, 12), share, strata) for _ in range(200)]
    covered = [e.low is not None and e.high is not None and e.low <= 0.7 <= e.high for e in estimates]

    assert 0.86 <= np.mean(covered) <= 1.0  # a percentile interval of 12 episodes is a bit narrow


def test_a_stratum_that_differs_does_not_widen_the_interval() -> None:
    values = np.array([[1.0, 10.0]] * 10 + [[9.0, 10.0]] * 10)
    apart = estimate(values, share, ["low"] * 10 + ["high"] * 10)
    mixed = estimate(values, share, ["all"] * 20)

    assert apart.low == pytest.approx(0.5)
    assert mixed.low is not None
    assert mixed.low < 0.4


def test_the_same_counts_give_the_same_interval() -> None:
    values = counts(np.random.default_rng(0), 20)

    assert estimate(values, share, ["a"] * 20) == estimate(values, share, ["a"] * 20)


def test_strata_of_one_episode_are_resampled_together() -> None:
    values = counts(np.random.default_rng(0), 10)
    alone = estimate(values, share, [str(number) for number in range(10)])
    one_left = estimate(values, share, ["a"] * 9 + ["b"])

    assert alone.low is not None
    assert one_left.low is not None


def test_few_episodes_give_no_interval() -> None:
    values = np.zeros((20, 2))
    values[:5] = 1.0

    assert estimate(values, share, ["a"] * 20) == Estimate(1.0)
    assert "too few episodes" in Estimate(1.0).text()


def test_nothing_to_count_is_undefined() -> None:
    assert estimate(np.zeros((20, 2)), share, ["a"] * 20).text() == "undefined"


def test_intervals_that_touch_are_not_above_each_other() -> None:
    assert Estimate(0.9, 0.8, 1.0).is_above(Estimate(0.6, 0.5, 0.7))
    assert not Estimate(0.9, 0.7, 1.0).is_above(Estimate(0.6, 0.5, 0.7))
    assert not Estimate(0.9).is_above(Estimate(0.6, 0.5, 0.7))
