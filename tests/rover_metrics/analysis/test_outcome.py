"""What an analysis says of logs: the statistics of each metric's series, put in their places."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from rover_metrics.analysis.logs.log import Log
from rover_metrics.analysis.metric import METRICS, other_metric
from rover_metrics.analysis.outcome import analyse
from rover_metrics.analysis.study import Member, Options, Study

MakeLog = Callable[..., Log]


def test_of_all_columns_constants_and_those_of_health_are_not_tested(make_log: MakeLog) -> None:
    """They would make the adjusted p of the others larger: here four metrics, of which one is tested."""
    members = []
    for number in range(8):
        speed = np.full(20, 0.1 * (number // 4) + 0.01 * number)
        columns = {"Current Velocity": speed, "Total Collisions": np.zeros(20)}
        columns |= {"Scan Rate [Hz]": 20.0 + speed, "Slip": np.full(20, 0.5)}
        members.append(Member(make_log(columns, np.arange(20.0)), f"log {number}", "ab"[number // 4]))
    metrics = (METRICS["CV"], METRICS["TC"], other_metric("Scan Rate [Hz]"), other_metric("Slip"))
    named = Study(tuple(members), ("a", "b"), Options(metrics))
    found = analyse(replace(named, options=Options(metrics, ranked=True)))
    assert {item.code: item.p_holm for item in found.comparisons} == {
        "CV": pytest.approx(2 / 70),  # of the ways to split eight logs
        "TC": None,
        "Scan Rate [Hz]": None,
        "Slip": None,
    }
    assert found.notes == ()
    assert all(item.p is not None for item in analyse(named).comparisons)  # who asks for it gets it
