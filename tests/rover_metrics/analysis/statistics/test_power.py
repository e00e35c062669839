"""What so few observations cannot show, against tests of groups that could not be further apart."""

from math import comb

import numpy as np
import pytest

from rover_metrics.analysis.statistics.comparison import compare, describe_power, holm


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
    assert list(describe_power([few, many, alone], "log", 0.05)) == [
        "So few logs cannot give a p below 0.05 for OC."
    ]
    assert told(1, 2) == ["No test: it needs two logs or more in each group."]
    assert list(describe_power([], "log", 0.05)) == []
    four = compare(
        "OC", np.arange(4.0), np.arange(4.0), 0.95
    )  # 2 / 70: not the first by Holm, but the second
    assert list(describe_power([four, many], "log", 0.05)) == []
    on_the_edge = compare("OC", np.arange(3.0), np.arange(3.0), 0.9)
    assert list(describe_power([on_the_edge], "log", 1 - 0.9)) == []  # 2 / 20
