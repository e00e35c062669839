"""What an analysis says of logs: the statistics of each metric's series, put in their places."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.metric import METRICS, other_metric
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.statistics.comparison import compare, holm
from rover_metrics.analysis.statistics.correlation import combine, correlate
from rover_metrics.analysis.statistics.summary import summarise_independent
from rover_metrics.analysis.study import Options, Study

MakeLog = Callable[..., Log]
CODES = ("DT", "CV", "VORT", "RT", "OC")


@pytest.fixture
def study(make_log: MakeLog) -> Study:
    """Two groups of three; the last has no clearance, each has two episodes and an outlier."""
    rng = np.random.default_rng(0)
    logs = []
    for number, rows in enumerate((40, 60, 50, 44, 70, 30)):
        speed = rng.random(rows) + 0.1 * number
        speed[5] = 30.0
        columns = {
            "Distance Traveled": np.cumsum(speed),
            "Current Velocity": speed,
            "Is Rough Terrain": (speed > 0.6).astype(float),
            "Obstacle Clearance": np.where(rng.random(rows) < 0.1, np.nan, rng.random(rows) - speed),
        }
        if number == 5:
            del columns["Obstacle Clearance"]
        stamps = np.arange(rows) + np.where(np.arange(rows) < 20, 0.0, 100.0)
        log, group = make_log(columns, stamps), "ab"[number // 3]
        logs.append(replace(log, findings=(f"odd {number}",), label=f"log {number}", group=group))
    metrics = tuple(METRICS[code] for code in CODES)
    return Study(tuple(logs), ("a", "b"), Options(metrics, 0.9, plots=("correlation",)))


def test_groups_are_summed_up_and_compared_by_the_means_of_their_logs(study: Study) -> None:
    result = analyse(study)
    means = {
        code: [
            [log.metrics[code].mean for log in result.logs if log.group == g and code in log.metrics]
            for g in "ab"
        ]
        for code in CODES
    }
    for code, groups in means.items():
        kind = METRICS[code].kind
        for name, values in zip("ab", groups, strict=True):
            expected = summarise_independent(np.array(values, float), kind, 0.9)
            assert result.across[name][code] == expected
    assert result.across["b"]["OC"].n == 2
    assert [item.code for item in result.comparisons] == list(CODES)
    plain = [
        compare(code, np.array(first, float), np.array(second, float), 0.9)
        for code, (first, second) in means.items()
    ]
    adjusted = holm([item.p for item in plain])
    for item, known, p in zip(result.comparisons, plain, adjusted, strict=True):
        assert item.difference == pytest.approx(known.difference)
        assert (item.n, item.p, item.p_holm) == (known.n, known.p, p)
    ranked = analyse(replace(study, options=replace(study.options, ranked=True))).comparisons
    sizes = {item.code: item.hedges_g or 0.0 for item in result.comparisons}
    order = sorted(CODES, key=lambda code: -abs(sizes[code]))
    assert [item.code for item in ranked] == order != sorted(CODES, key=lambda code: -sizes[code])
    alone = replace(study, groups=("a",), logs=study.logs[:3])
    assert analyse(alone).comparisons == ()
    paired = replace(study, pairs=((0, 2), (1, 0), (2, 1))).compared(METRICS["OC"])
    of_logs = [log.metrics["OC"].mean for log in result.logs[:-1]]  # the last has none, nor its partner
    assert [list(means) for means in paired] == [
        pytest.approx(of_logs[1:3]),
        pytest.approx(of_logs[3:]),
    ]


def test_of_all_columns_constants_and_those_of_health_are_not_tested(make_log: MakeLog) -> None:
    """They would make the adjusted p of the others larger: here four metrics, of which one is tested."""
    logs = []
    for number in range(8):
        speed = np.full(20, 0.1 * (number // 4) + 0.01 * number)
        columns = {"Current Velocity": speed, "Total Collisions": np.zeros(20)}
        columns |= {"Scan Rate [Hz]": 20.0 + speed, "Slip": np.full(20, 0.5)}
        group, log = "ab"[number // 4], make_log(columns, np.arange(20.0))
        logs.append(replace(log, label=f"log {number}", group=group))
    metrics = (METRICS["CV"], METRICS["TC"], other_metric("Scan Rate [Hz]"), other_metric("Slip"))
    named = Study(tuple(logs), ("a", "b"), Options(metrics))
    found = analyse(replace(named, options=Options(metrics, ranked=True)))
    assert {item.code: item.p_holm for item in found.comparisons} == {
        "CV": pytest.approx(2 / 70),  # of the ways to split eight logs
        "TC": None,
        "Scan Rate [Hz]": None,
        "Slip": None,
    }
    assert found.notes == ()
    assert all(item.p is not None for item in analyse(named).comparisons)  # who asks for it gets it


def test_an_episode_is_an_observation_on_request(study: Study) -> None:
    by_episode = replace(study, options=replace(study.options, unit="episode"))
    observed = by_episode.observations(METRICS["CV"], "b")
    speeds = [log.columns["Current Velocity"].astype(float) for log in study.logs[3:]]
    expected = [part.mean() for speed in speeds for part in (speed[:20], speed[20:])]
    assert observed == pytest.approx(expected)
    assert study.observations(METRICS["CV"], "b") == pytest.approx([s.mean() for s in speeds])
    result = analyse(by_episode)
    assert result.unit == "episode"
    assert {item.code: item.n for item in result.comparisons}["OC"] == (6, 4)


def test_pairs_of_metrics_are_correlated(study: Study, monkeypatch: pytest.MonkeyPatch) -> None:
    result = analyse(study)
    pairs = [(item.first, item.second) for item in result.correlations]
    assert ("CV", "VORT") not in pairs
    assert ("DT", "CV") in pairs
    assert ("VORT", "OC") in pairs
    by_log = [{(c.first, c.second): c for c in log.correlations} for log in result.logs]
    log = study.logs[0]
    clearance = log.columns["Obstacle Clearance"].astype(float)
    direct = correlate("CV", "OC", log.columns["Current Velocity"].astype(float), clearance)
    assert direct is not None
    assert by_log[0]["CV", "OC"].rho == direct.rho
    for found in (result.correlations, *(log.correlations for log in result.logs)):
        assert [item.p_holm for item in found] == holm([item.p for item in found])
    for item in result.correlations:
        parts = [
            pairs[item.first, item.second] for pairs in by_log if (item.first, item.second) in pairs
        ]
        assert (item.rho, item.n) == (combine(parts).rho, sum(part.n for part in parts))
    plain = analyse(replace(study, options=Options(study.options.metrics)))
    assert {plain.correlations, *(log.correlations for log in plain.logs)} == {()}
    monkeypatch.setattr("rover_metrics.analysis.outcome._MOST_CORRELATED", 20)  # of a long log some rows
    first = analyse(replace(study, logs=study.logs[:1])).logs[0]
    assert {(c.first, c.second): c.n for c in first.correlations}["CV", "RT"] == 20
