"""Spinning until something holds, on a clock of the test's own."""

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.ros.context import spin_until, spin_until_quiet


@pytest.mark.parametrize(
    ("changes", "ends"),
    [
        ([], 0.3),
        ([0.1], 0.4),
        ([0.1, 0.3, 0.5], 0.8),
        ([n / 10 for n in range(1, 40)], 2.0),
    ],
)
def test_it_is_quiet_when_nothing_has_changed_for_long_enough_or_nobody_waits_longer(
    changes: list[float], ends: float
) -> None:
    clock = [0.0]

    def spin_once(timeout_sec: float) -> None:
        clock[0] = round(clock[0] + timeout_sec, 6)

    def look() -> int:
        return sum(clock[0] >= change for change in changes)

    executor: Any = SimpleNamespace(spin_once=spin_once)
    spin_until_quiet(executor, look, quiet=0.3, patience=2.0, now=lambda: clock[0])
    assert clock[0] == pytest.approx(ends)


@pytest.mark.parametrize(
    ("stopped", "comes", "came"), [(0.0, 4.9, True), (0.0, 5.3, False), (100.0, 103.0, True)]
)
def test_patience_is_of_time_in_which_this_process_runs(
    stopped: float, comes: float, came: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock, stops = [0.0], iter([stopped])
    monkeypatch.setattr("harness.ros.context.time.monotonic", lambda: clock[0])

    def spin_once(timeout_sec: float) -> None:
        clock[0] += timeout_sec + next(stops, 0.0)

    executor: Any = SimpleNamespace(spin_once=spin_once)
    assert spin_until(executor, lambda: clock[0] > comes, 5.0) == came
