"""Numbers with their uncertainty."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from harness.tune.scoring.estimate import Estimate, estimate, ratio


def share(sums: NDArray[np.float64]) -> NDArray[np.float64]:
    return ratio(sums[..., 0], sums[..., 1])


@pytest.mark.parametrize(
    ("strata", "groups"),
    [
        (["a"] * 40, [range(40)]),
        (["a"] * 2 + ["b"] * 2 + ["c"] * 36, [range(2), range(2, 4), range(4, 40)]),
        (["a"] * 30 + list("bcdefghijk"), [range(30), range(30, 40)]),  # single ones are one stratum
        (["a"] * 15 + ["b"] * 24 + ["c"], [range(15), range(15, 40)]),  # a lone one joins the largest
        (["a"] * 24 + ["b"] * 15 + ["c"], [[*range(24), 39], range(24, 39)]),
    ],
)
def test_a_sum_has_the_error_of_a_stratified_sample(strata: list[str], groups: list[range]) -> None:
    """The variance of a total is the sum of n_h s_h^2 over the strata; the interval is normal."""
    rng = np.random.default_rng(3)
    values = rng.normal(5.0, 1.0, 40)
    values[list(groups[0])] -= 20.0
    values[list(groups[-1])] += 20.0  # strata differ: a wrong grouping widens the interval
    values[39] += 9.0
    found = estimate(values[:, None], lambda sums: sums[..., 0], strata)
    assert found.low is not None
    assert found.high is not None
    members = [values[list(group)] for group in groups]
    error = math.sqrt(sum(len(group) * group.var(ddof=1) for group in members))
    assert found.value == pytest.approx(values.sum())
    assert found.high - found.low == pytest.approx(2 * norm.ppf(0.975) * error, rel=0.045)
    assert (found.high + found.low) / 2 == pytest.approx(found.value, abs=0.25 * error)


def test_fewer_than_eight_episodes_with_counts_give_no_interval_nor_does_what_is_undefined() -> None:
    for episodes, expected in ((7, Estimate(0.0)), (8, Estimate(0.0, 0.0, 0.0))):
        values = np.zeros((20, 2))
        values[:episodes] = (0.0, 1.0)
        assert estimate(values, share, ["a"] * 20) == expected
    values = np.tile((1.0, 0.0), (20, 1))
    values[0, 1] = 1.0  # only one episode has what it is divided by
    assert estimate(values, share, ["a"] * 20) == Estimate(20.0)


def test_a_ratio_is_undefined_without_a_whole_and_so_is_nothing_to_count() -> None:
    part, whole = np.array([1.0, 0.0, 2.0]), np.array([4.0, 0.0, 0.0])
    assert ratio(part, whole).tolist() == pytest.approx([0.25, math.nan, math.nan], nan_ok=True)
    assert estimate(np.zeros((20, 2)), share, ["a"] * 20).text() == "undefined"
    assert Estimate(0.934, 0.876, 0.965).text() == "0.93 (0.88 to 0.96)"
    assert Estimate(0.934).text(1) == "0.9 (too few episodes for an interval)"
