"""Two groups of observations, against scipy and every pair or split counted."""

from itertools import combinations, product
from math import comb

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from rover_metrics.analysis.logs.log import Floats
from rover_metrics.analysis.statistics.comparison import compare, describe_power, holm

A = np.array([1.0, 2.0, 3.0, 4.0])
B = np.array([6.0, 7.0, 8.0, 9.0])
FEW = st.lists(st.integers(0, 6), min_size=2, max_size=5).map(lambda v: np.array(v, float))


def exact_p(first: Floats, second: Floats) -> float:
    """Share of the splits whose means differ at least as much; two-sided as twice the nearer tail."""
    everyone = np.concatenate((first, second))
    seen, differences = second.mean() - first.mean(), []
    for chosen in combinations(range(everyone.size), first.size):
        rest = np.delete(everyone, chosen)
        differences.append(rest.mean() - everyone[list(chosen)].mean())
    above, below = np.array(differences) >= seen - 1e-9, np.array(differences) <= seen + 1e-9
    return float(min(1.0, 2 * min(above.mean(), below.mean())))


@pytest.mark.filterwarnings("ignore:Precision loss")  # of scipy, where a group is constant
@settings(max_examples=40)
@given(FEW, FEW)
def test_few_observations_are_judged_by_every_split_and_pair(first: Floats, second: Floats) -> None:
    result = compare("CV", first, second, 0.9)
    sizes = (first.size, second.size)
    assert (result.code, result.n, result.test) == ("CV", sizes, "exact permutation")
    assert list(result.means) == pytest.approx([first.mean(), second.mean()])
    assert result.difference == pytest.approx(second.mean() - first.mean())
    assert result.p == pytest.approx(exact_p(first, second))
    signs = np.sign(second[:, None] - first[None, :])
    assert result.cliffs_delta == pytest.approx(signs.mean())
    freedom = first.size + second.size - 2
    pooled = np.sqrt((first.var() * first.size + second.var() * second.size) / freedom)
    if pooled:
        g = (second.mean() - first.mean()) / pooled * (1 - 3 / (4 * freedom - 1))
        assert result.hedges_g == pytest.approx(g)
        welch = stats.ttest_ind(second, first, equal_var=False).confidence_interval(0.9)
        assert result.interval == pytest.approx((welch.low, welch.high))
    else:
        assert (result.hedges_g, result.interval) == (None, None)


@pytest.mark.parametrize(
    ("sizes", "test", "smallest"),
    [
        ((3, 3), "exact permutation", 2 / 20),
        ((2, 1 + 1), "exact permutation", 2 / 6),
        ((8, 8), "exact permutation", 2 / 12_870),
        ((9, 8), "Mann-Whitney U", 2 / 24_310),
    ],
)
def test_the_number_of_splits_decides(sizes: tuple[int, int], test: str, smallest: float) -> None:
    rng = np.random.default_rng(0)
    a, b = rng.exponential(1, sizes[0]), 100 + rng.exponential(2, sizes[1])
    result = compare("CV", a, b, 0.95)
    assert result.test == test
    assert [result.p, result.smallest_p] == pytest.approx([smallest] * 2)  # all below all
    if test == "Mann-Whitney U":
        mixed = np.concatenate((b[:4], a[4:]))
        expected = stats.mannwhitneyu(mixed, b).pvalue
        assert compare("CV", mixed, b, 0.95).p == pytest.approx(expected)


def test_one_observation_or_none_gives_no_test() -> None:
    for first, second, difference in ((A[:1], B, 6.5), (A, B[:1], 3.5)):
        alone = compare("CV", first, second, 0.95)
        assert (alone.test, alone.p, alone.interval, alone.hedges_g) == (None, None, None, None)
        assert (alone.difference, alone.cliffs_delta) == (difference, 1.0)
    nothing = compare("CV", A[:0], B, 0.95)
    assert (nothing.n, nothing.means) == ((0, 4), (None, 7.5))
    assert nothing.difference is nothing.cliffs_delta is None


@given(st.lists(st.none() | st.floats(0.0, 1.0), max_size=6))
def test_many_p_are_adjusted_by_the_step_down_of_holm(
    probabilities: list[float | None],
) -> None:
    """1979: p(j) becomes the largest of (m - i + 1) p(i) for all i up to j, and 1 at most."""
    known = sorted(p for p in probabilities if p is not None)
    for p, adjusted in zip(probabilities, holm(probabilities), strict=True):
        if p is None:
            assert adjusted is None
        else:
            steps = [min(1.0, (len(known) - i) * q) for i, q in enumerate(known) if q <= p]
            assert adjusted == pytest.approx(max(steps))
    textbook = holm([0.01, 0.04, None, 0.03, 0.005])
    assert textbook == pytest.approx([0.03, 0.06, None, 0.06, 0.02])


PAIRS = st.lists(st.tuples(st.integers(0, 5), st.integers(0, 5)), min_size=2, max_size=6)


@pytest.mark.filterwarnings("ignore:Precision loss")
@settings(max_examples=40)
@given(PAIRS)
def test_few_pairs_are_judged_by_every_way_to_flip_their_signs(pairs: list[tuple[int, int]]) -> None:
    first, second = np.array(pairs, float).T
    result = compare("CV", first, second, 0.9, paired=True)
    differences = second - first
    means = [(differences * signs).mean() for signs in product((-1, 1), repeat=len(pairs))]
    seen = differences.mean()
    above, below = np.array(means) >= seen - 1e-9, np.array(means) <= seen + 1e-9
    assert result.p == pytest.approx(min(1.0, 2 * min(above.mean(), below.mean())))
    assert (result.paired, result.test) == (True, "exact sign flips")
    assert result.smallest_p == pytest.approx(2 / 2 ** len(pairs))
    unpaired = compare("CV", first, second, 0.9)
    assert (result.difference, result.hedges_g) == (unpaired.difference, unpaired.hedges_g)
    if np.ptp(differences):
        student = stats.ttest_rel(second, first).confidence_interval(0.9)
        assert result.interval == pytest.approx((student.low, student.high))
    else:
        assert result.interval is None


def test_many_pairs_are_judged_by_wilcoxons_signed_ranks() -> None:
    rng = np.random.default_rng(0)
    first, second = rng.normal(size=(2, 15)) + np.array([[0.0], [0.5]])
    assert compare("CV", first[:14], second[:14], 0.95, paired=True).test == "exact sign flips"
    result = compare("CV", first, second, 0.95, paired=True)
    assert result.test == "Wilcoxon signed-rank"
    assert result.p == pytest.approx(stats.wilcoxon(second, first).pvalue)
    assert compare("CV", first, first, 0.95, paired=True).p == 1.0


@pytest.mark.parametrize(
    ("first", "second", "effect"),
    [
        ([1, 3], [1, 3], 0.0),
        ([1, 1], [1, 1], 0.0),
        ([1, 1], [2, 2], np.inf),
        ([1], [2, 3], 0.0),
        ([1, 3], [4, 6], 3 / np.sqrt(2) * 4 / 7),
    ],
)
def test_an_effect_has_no_sign(first: list[float], second: list[float], effect: float) -> None:
    groups = np.array(first, float), np.array(second, float)
    for a, b in (groups, groups[::-1]):
        assert compare("CV", a, b, 0.95).effect == pytest.approx(effect)


def told(logs: int, metrics: int, *, paired: bool = False, alpha: float = 1 - 0.95) -> list[str]:
    apart = (np.arange(float(logs)), 100 + np.arange(float(logs)))
    found = [compare(f"M{i}", *apart, 0.95, paired=paired) for i in range(metrics)]
    notes = list(describe_power(found, "log", alpha))
    adjusted = [p for p in holm([each.p for each in found]) if p is not None]
    assert bool(notes) == (not adjusted or min(adjusted) > alpha + 1e-9)
    return notes


def test_it_is_told_whether_any_p_can_pass_after_holms_correction() -> None:
    assert told(5, 3) == []  # 3 x 2 / 252
    (note,) = told(4, 3)
    assert note == (
        "So few logs cannot give a p (Holm) below 0.086 among 3 metrics, whatever they show: no "
        "difference can be told at 0.05. It takes 5 logs in each group, or fewer metrics with -m."
    )
    assert told(4, 1) == []
    (alone,) = told(3, 1)
    assert "below 0.1, whatever they show" in alone
    assert alone.endswith("It takes 4 logs in each group.")
    assert "(Holm) below 1 among 4" in told(2, 4)[0]  # not 4 x 2 / 6


@pytest.mark.parametrize("metrics", [1, 2, 11])
def test_as_many_as_it_takes_are_enough_and_one_less_is_not(metrics: int) -> None:
    enough = next(n for n in range(2, 20) if metrics * 2 / comb(2 * n, n) <= 0.05)
    assert (told(enough, metrics), len(told(enough - 1, metrics))) == ([], 1)
    pairs = next(n for n in range(2, 20) if metrics * 2 / 2**n <= 0.05)
    assert told(pairs, metrics, paired=True) == []
    assert f"It takes {pairs} logs" in told(pairs - 1, metrics, paired=True)[0]


def test_metrics_of_fewer_logs_are_named_and_without_any_test_nothing_else_is_said() -> None:
    few = compare("OC", np.arange(3.0), np.arange(3.0), 0.95)
    many = compare("CV", np.arange(9.0), np.arange(9.0), 0.95)
    alone = compare("VR", np.arange(1.0), np.arange(9.0), 0.95)  # no test, so nothing is said of it
    note = "So few logs cannot give a p below 0.05 for OC."
    assert list(describe_power([few, many, alone], "log", 0.05)) == [note]
    assert told(1, 2) == ["No test: it needs two logs or more in each group."]
    assert list(describe_power([], "log", 0.05)) == []
    four = compare("OC", np.arange(4.0), np.arange(4.0), 0.95)  # 2 / 70: not the first by Holm
    assert list(describe_power([four, many], "log", 0.05)) == []
    on_the_edge = compare("OC", np.arange(3.0), np.arange(3.0), 0.9)
    assert list(describe_power([on_the_edge], "log", 1 - 0.9)) == []  # 2 / 20
