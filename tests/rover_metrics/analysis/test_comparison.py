import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.comparison import cliffs_delta, compare

A = np.array([1.0, 2.0, 3.0, 4.0])
B = np.array([6.0, 7.0, 8.0, 9.0])


def test_few_observations_get_an_exact_permutation_test() -> None:
    result = compare("CV", A, B, 0.95)
    assert result.test == "exact permutation"
    assert result.p == pytest.approx(2 / 70)  # the most extreme of 70 splits, on two sides
    assert result.smallest_p == pytest.approx(2 / 70)
    assert result.difference == 5.0


def test_many_observations_get_mann_whitney() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.exponential(1, 30), rng.exponential(2, 30)
    result = compare("CV", a, b, 0.95)
    assert result.test == "Mann-Whitney U"
    assert result.p == pytest.approx(stats.mannwhitneyu(a, b).pvalue)


def test_the_interval_is_welchs() -> None:
    a, b = np.array([1.0, 2.0, 3.0, 4.0, 5.0]), np.array([2.0, 9.0, 4.0])
    welch = stats.ttest_ind(b, a, equal_var=False).confidence_interval(0.9)
    assert compare("CV", a, b, 0.9).interval == pytest.approx((welch.low, welch.high))


def test_effect_sizes_are_those_of_a_hand_calculation() -> None:
    result = compare("CV", A, B, 0.95)
    assert result.hedges_g == pytest.approx(5 / np.sqrt(5 / 3) * (1 - 3 / 23))
    assert result.cliffs_delta == 1.0
    # Of four pairs two are above, one below, one equal.
    assert cliffs_delta(np.array([1.0, 2.0]), np.array([1.0, 3.0])) == 0.25
    assert cliffs_delta(B, A) == -1.0


def test_equal_groups_do_not_differ() -> None:
    result = compare("CV", A, A, 0.95)
    assert (result.p, result.difference, result.cliffs_delta) == (1.0, 0.0, 0.0)


def test_three_against_three_cannot_be_significant_and_say_so() -> None:
    result = compare("CV", A[:3], B[:3], 0.95)
    assert result.p == result.smallest_p == pytest.approx(0.1)


def test_one_observation_or_none_gives_no_test() -> None:
    alone = compare("CV", A[:1], B, 0.95)
    assert (alone.test, alone.p, alone.interval, alone.hedges_g) == (None, None, None, None)
    assert alone.difference == 6.5
    nothing = compare("CV", A[:0], B, 0.95)
    assert nothing.means == (None, 7.5)
    assert nothing.difference is None


def test_groups_without_variance_have_a_p_value_but_no_standardised_difference() -> None:
    result = compare("TC", np.zeros(3), np.ones(3), 0.95)
    assert (result.hedges_g, result.interval) == (None, None)
    assert result.p == pytest.approx(0.1)
