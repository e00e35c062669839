"""Faults of the clock."""

import pytest

from harness.base.sim_time import NANOSECONDS as SECOND
from harness.base.sim_time import TICK_NS
from tests.harness.faults.faulty_ticks import imus, sent, times


def clock_times(*specs: str) -> list[float]:
    return [one.stamp_ns / SECOND for one in sent(*specs) if one.tells_time]


@pytest.mark.parametrize(
    ("spec", "expected"),
    [
        ("clock:jump=5@2", [1.99, 7.0, 7.01]),
        ("clock:jump=-1.5@2", [1.99, 0.5, 0.51]),
        ("clock:jump=2.01@2", [1.99, 4.01, 4.02]),  # to the nearest nanosecond
        ("clock:jump=-30@2", [1.99, 0.01, 0.02]),
        ("clock:jump=5@1.995", [1.99, 7.0, 7.01]),  # with the first tick from then on
        ("clock:reset@2", [1.99, 0.01, 0.02]),
        ("clock:speed=0.5@2", [1.99, 1.995, 2.0]),
        ("clock:speed=1.00000007@2", [1.99, 2.000000001, 2.010000002]),  # to the nearest nanosecond
        ("clock:freeze@2+1", [1.99, 1.99, 1.99]),
        ("clock:freeze", [0.0, 0.0, 0.0]),
    ],
)
def test_time_goes_another_way_at_the_start_of_a_clock_fault(spec: str, expected: list[float]) -> None:
    assert clock_times(spec)[198:201] == expected


def test_stamps_follow_the_simulators_time() -> None:
    for one in sent("clock:jump=5@1", "clock:speed=3@2+1", "clock:reset@3"):
        assert {sample.stamp_ns for sample in one.samples} == {one.stamp_ns}


def test_stamps_go_on_while_the_clock_alone_fails_and_it_then_catches_up() -> None:
    for spec in ("clock:freeze@1+1", "clock:dropout@1+1"):
        assert times(imus(spec)) == [n / 100 for n in range(1, 401)]
        assert clock_times(spec)[-200:] == [n / 100 for n in range(201, 401)]
    assert clock_times("clock:freeze@1+1", "clock:freeze@1.5+1")[98:251:25] == [0.99] * 7
    assert clock_times("clock:freeze@1+1", "clock:freeze@1.5+1")[249] == 2.5
    silent = "clock:dropout@1.2+0.2"  # what is not sent is not what is repeated
    assert clock_times("clock:freeze@1+1", silent)[98:181:41] == [0.99, 0.99, 2.01]
    assert times(imus("clock:freeze@1+1", "clock:jump=5@1.5"))[148:151] == [1.49, 6.5, 6.51]
    assert len(clock_times("clock:dropout@1+1")) == 300
    assert [one.stamp_ns for one in sent("clock:dropout@1+1")] == [n * TICK_NS for n in range(1, 401)]
    assert len(clock_times("clock:dropout@1+1", "clock:dropout@1.5+1")) == 250
    assert len(clock_times("clock:dropout@1.5+1", "clock:dropout@1+1", "clock:dropout=1e-9")) == 250


def test_time_runs_faster_for_as_long_as_the_fault_lasts() -> None:
    assert clock_times("clock:speed=3@1+1")[-1] == 4.0 + 2 * 1.0
    assert clock_times("clock:speed=3@1+1", "clock:speed=2@1+1")[-1] == 4.0 + 5 * 1.0
    assert clock_times("clock:speed=3@1+1")[97:101] == [0.98, 0.99, 1.02, 1.05]
