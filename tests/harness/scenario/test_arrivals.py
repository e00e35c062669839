"""What topics were over time, against sums over the same messages in plain Python."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from harness.scenario.arrivals import Arrivals, topic_series
from harness.scenario.names import HeardQuantity
from harness.scenario.series import Series

TICK_NS, END_NS = 10_000_000, 3_000_000_000
TICKS = st.lists(st.integers(0, 300), max_size=40).map(sorted)


def message(stamp_ns: int, *values: float) -> Any:  # noqa: ANN401 - as rclpy has it
    stamp = SimpleNamespace(sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp), values=values)


def arrivals(*times_ns: int, clock_ns: int = 0, before_ns: int = 0) -> Arrivals:
    """Messages heard at these times, on a clock that is ahead; each stamp is older than the last."""
    made = Arrivals(["values"])
    for index, time_ns in enumerate(times_ns, 1):
        shown = _paused(time_ns) + clock_ns
        made.take(message(shown - index * before_ns), time_ns, shown)
    return made


def _paused(time_ns: int) -> int:
    """What a clock shows that stands from 1.5 s to 2 s."""
    return time_ns - max(0, min(time_ns, 2 * 10**9) - 3 * 10**9 // 2)


def series(what: str, heard: dict[str, Arrivals], of: str | None = None) -> Series:
    return topic_series(HeardQuantity("/a", what), of, heard, [*heard, "/other"], END_NS)


@settings(max_examples=30)
@given(TICKS)
def test_count_and_rate_are_those_of_plain_counting(ticks: list[int]) -> None:
    heard = {"/a": arrivals(*(tick * TICK_NS for tick in ticks))}
    count = series("count", heard)
    assert count.is_tally
    assert count.times == pytest.approx([tick / 100 for tick in ticks])
    rate = series("rate", heard)
    assert rate.times == pytest.approx([1.0 + 0.05 * n for n in range(41)])
    ends = [100 + 5 * n for n in range(41)]
    assert list(rate.values) == [sum(end - 100 < tick <= end for tick in ticks) for end in ends]
    sooner = topic_series(HeardQuantity("/a", "rate"), None, heard, heard, END_NS - 1)
    assert list(sooner.times) == list(rate.times[:-1])


@settings(max_examples=30)
@example([160], [151, 170], 1)  # while the clock stands
@given(TICKS, TICKS, st.integers(0, 50))
def test_latency_is_from_the_newest_input_that_was_heard(
    outputs: list[int], inputs: list[int], older: int
) -> None:
    heard = {
        "/a": arrivals(*(tick * TICK_NS for tick in outputs), clock_ns=7),
        "/in": arrivals(*(tick * TICK_NS for tick in inputs), clock_ns=7, before_ns=older * TICK_NS),
    }
    expected = []
    for output in outputs:
        count = sum(tick <= output for tick in inputs)
        stamp = _paused(inputs[count - 1] * TICK_NS) - count * older * TICK_NS if count else math.nan
        expected.append((_paused(output * TICK_NS) - stamp) / 1e9)
    assert list(series("latency", heard, "/in").values) == pytest.approx(expected, nan_ok=True)


def test_age_is_on_the_clock_of_the_listeners_and_times_are_since_the_start() -> None:
    heard = {"/a": arrivals(10**9, 2 * 10**9, clock_ns=5 * 10**9, before_ns=10**8)}
    heard["/a"].take(SimpleNamespace(values=()), 3 * 10**9, 7 * 10**9)  # of no age: it has no header
    age = series("age", heard)
    assert (list(age.times), age.unit) == ([1.0, 2.0, 3.0], "s")
    assert list(age.values) == pytest.approx([0.1, 0.2, 0.0])


def test_a_field_has_the_time_of_its_message_for_each_of_its_numbers() -> None:
    made = Arrivals(["header.stamp.sec", "values"])
    for time_ns, values in ((10**9, (1.0, 2.0)), (2 * 10**9, ()), (3 * 10**9, (np.inf,))):
        made.take(message(0, *values), time_ns, time_ns)
    field = series("values", {"/a": made})
    assert list(field.times) == [1.0, 1.0, 3.0]
    assert list(field.values) == [1.0, 2.0, np.inf]
    assert field.unit == ""


@pytest.mark.parametrize(
    ("what", "heard", "nothing"),
    [
        ("age", {"/a": arrivals()}, "nothing was heard on /a"),
        ("values", {"/a": arrivals()}, "nothing was heard on /a"),
        ("values", {"/a": arrivals(5)}, "there is no value"),
        ("latency", {"/a": arrivals(), "/in": arrivals(5)}, "nothing was heard on /a"),
        ("latency", {"/a": arrivals(5), "/in": arrivals()}, "nothing was heard on /in before /a"),
        ("latency", {"/x": arrivals(5)}, "topic '/a' does not exist"),
        ("latency", {"/a": arrivals(5), "/inn": arrivals()}, "topic '/in' does not exist; did you mean"),
        ("count", {"/ab": arrivals()}, "topic '/a' does not exist; did you mean '/ab'?"),
        ("rate", {"/x/y": arrivals()}, "topic '/a' does not exist; available: /x/y, /other"),
    ],
)
def test_where_nothing_came_the_reason_is_told(
    what: str, heard: dict[str, Arrivals], nothing: str
) -> None:
    found = series(what, heard, "/in" if what == "latency" else None)
    assert np.isnan(found.values).all()
    assert len(found.times) == len(found.values)
    assert not found.is_tally
    assert found.nothing.startswith(nothing)
