"""Spinning until something holds, on a clock of the test's own, and what waits, with real executors."""

from contextlib import redirect_stderr
from io import StringIO
from types import SimpleNamespace
from typing import Any

import pytest

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from std_msgs.msg import Empty

from harness.ros.context import Interval, make_executor, serve_waiting, spin_until, spin_until_quiet
from tests.support.ros import Ros
from tests.support.waiting import PATIENCE


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


@pytest.mark.parametrize("time_jumps", [False, True])
def test_all_that_waits_is_served_by_either_executor(ros: Ros, *, time_jumps: bool) -> None:
    heard: list[str] = []
    with redirect_stderr(StringIO()):  # as pytest --capture=sys does
        made = make_executor(ros.context, time_jumps=time_jumps)
    with made as executor:
        node = rclpy.create_node("someone", context=ros.context, enable_rosout=False)
        executor.add_node(node)
        ways = {name: node.create_publisher(Empty, name, 10) for name in "ab"}
        for name in ways:
            node.create_subscription(Empty, name, lambda _, name=name: heard.append(name), 10)
        assert spin_until(
            executor, lambda: all(w.get_subscription_count() for w in ways.values()), PATIENCE
        )
        serve_waiting(executor)  # from now on it knows who is new
        for name in "aba":
            ways[name].publish(Empty())
        serve_waiting(executor)
        assert sorted(heard) == ["a", "a", "b"]
        node.destroy_node()


def test_an_interval_is_over_at_once_and_then_each_time_it_has_passed() -> None:
    seconds = iter([3.0, 3.1, 3.4, 3.5, 3.9, 9.0, 9.4])
    interval = Interval(0.5, clock=lambda: next(seconds))
    assert [interval.is_over() for _ in range(7)] == [True, False, False, True, False, True, False]
