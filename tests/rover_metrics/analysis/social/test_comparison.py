"""RoboTerrain's published figures from its own logs, and pairs of groups against scipy."""

from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from rover_metrics.analysis.social.comparison import Group, differences, make_group
from rover_metrics.analysis.social.log import read_social_log
from rover_metrics.analysis.social.metrics import RunFigures

SOCIAL = Path(__file__).parents[5] / "shared/data/roboterrain/social"


@pytest.mark.skipif(not SOCIAL.is_dir(), reason="needs the RoboTerrain logs in ../shared/data")
def test_the_published_figures_are_reproduced() -> None:
    """Inspect, With Attention against Nav2 (w/reverse): its inspect_results4.csv, U with 93 and 29."""
    groups = {
        name: make_group(name, [read_social_log(path) for path in sorted((SOCIAL / name).glob("*.csv"))])
        for name in ("Nav2_lidar_reverse", "attention")
    }
    risk, seconds = differences(groups, 0.95)
    assert risk.windows.means == pytest.approx((0.542105, 0.168750), abs=5e-7)
    assert risk.windows.difference == pytest.approx(-0.373355, abs=5e-7)
    assert risk.windows.interval == pytest.approx((-0.533210, -0.213501), abs=5e-7)
    assert risk.windows.p == pytest.approx(0.000029, abs=5e-7)
    assert risk.cohens_d == pytest.approx(-1.717666, abs=5e-7)
    assert seconds.windows.means == pytest.approx((27.015789, 16.725), abs=5e-7)
    assert seconds.windows.interval == pytest.approx((-13.170397, -7.411181), abs=5e-7)
    assert seconds.cohens_d == pytest.approx(-2.548808, abs=5e-7)
    assert (risk.windows.test, risk.windows.n) == ("Mann-Whitney U", (19, 32))
    assert (risk.runs.test, risk.runs.n, risk.runs.p) == ("exact permutation", (3, 3), 0.1)


def test_each_pair_is_tested_and_adjusted_metric_by_metric() -> None:
    rng = np.random.default_rng(0)
    values = {
        name: shift + rng.exponential(1.0, (8, 2)) for name, shift in (("a", 0), ("b", 1), ("c", 5))
    }
    runs = {
        name: tuple(
            RunFigures(0, 0, 0, None, {}, 0, None, 0, risk_s_per_goal=k + i, s_per_goal=10 * k + i)
            for i in range(4)
        )
        for k, name in zip((0, 10, 20), "abc", strict=True)
    }
    groups = {name: Group(name, (), runs[name], windows) for name, windows in values.items()}
    found = differences(groups, 0.9)
    pairs = [("a", "b"), ("a", "c"), ("b", "c")]
    assert [each.groups for each in found] == pairs * 2
    for column, metric in enumerate(("risk_s_per_goal", "s_per_goal")):
        of_metric = [each for each in found if each.metric == metric]
        one = {name: windows[:, column] for name, windows in values.items()}
        plain = [stats.mannwhitneyu(one[a], one[b]).pvalue for a, b in pairs]
        assert [each.windows.p for each in of_metric] == pytest.approx(plain)
        adjusted = [each.windows.p_holm for each in of_metric]
        assert min(p for p in adjusted if p) == pytest.approx(3 * min(plain))
        a, b = (values[name][:, column] for name in pairs[0])
        pooled = np.sqrt((a.var(ddof=1) + b.var(ddof=1)) / 2)  # groups of equal size
        assert of_metric[0].cohens_d == pytest.approx((b.mean() - a.mean()) / pooled)
    assert {each.windows.test for each in found} == {"Mann-Whitney U"}  # of few windows too
    # Of the runs all of the one lie below all of the other, one split of 70 and its mirror.
    told = {(each.runs.n, each.runs.difference, round(each.runs.p_holm or 0, 9)) for each in found}
    holm = round(3 * 2 / 70, 9)
    assert told == {((4, 4), k * gap, holm) for k in (1, 10) for gap in (10.0, 20.0)}
    groups = {name: Group(name, (), (), np.ones((1, 2))) for name in "ab"}  # one window is not tested
    assert {(each.windows.p, each.cohens_d) for each in differences(groups, 0.95)} == {(None, None)}
