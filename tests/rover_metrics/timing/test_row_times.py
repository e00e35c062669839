"""When rows come, live and as /clock goes on, against the rules in their own words.

rcl_timer_call and _rcl_timer_time_jump of rcl/timer.c; JumpThreshold as row_timer.py registers it.
"""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.timing.row_times import RowSchedule, RowTimes

SECOND = 10**9
PERIOD = 6  # of the model: small, so that every edge is met
STARTS = st.integers(0, 2 * PERIOD)
CLOCKS = st.lists(st.integers(0, 6 * PERIOD), max_size=20)
BACK, AHEAD = "the clock went back", "the clock leapt ahead"

Event = int | str  # a timer that fires at that time, or what the clock did


def rows(times: RowTimes, events: Sequence[Event]) -> list[Event]:
    """Give the firings of which a row was written."""
    written: list[Event] = []
    for event in events:
        if event == BACK:
            times.went_back()
        elif event == AHEAD:
            times.leapt_ahead()
        elif times.is_due(int(event)):
            written.append(event)
    return written


def rows_of_the_rule(events: Sequence[Event], period: int) -> list[Event]:
    """The rule by its words: a row is refused to a firing less than half a period from the latest row,
    with the same timestamp, unless the clock's latest deed since that row was to go back."""
    written: list[Event] = []
    deeds: list[Event] = []
    for event in events:
        if isinstance(event, str):
            deeds.append(event)
            continue
        near = [at for at in range(event - period, event + period) if 2 * abs(at - event) < period]
        same = [at for at in near if at // period == event // period]
        if deeds[-1:] == [BACK] or not written or written[-1] not in same:
            written.append(event)
            deeds = []
    return written


@given(st.lists(st.integers(0, 4 * PERIOD) | st.sampled_from([BACK, AHEAD]), max_size=20))
def test_rows_and_segments_are_those_of_the_rule(events: list[Event]) -> None:
    times = RowTimes(PERIOD)
    written = rows(times, events)
    assert written == rows_of_the_rule(events, PERIOD)
    assert times.segments == 1 + events.count(BACK)


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([1.0, 1.0, 1.01, 2.0, 2.0], [1.0, 2.0]),  # fires twice
        ([1.0, 2.9, 3.0, 4.0], [1.0, 2.9, 3.0, 4.0]),  # fires late
        ([1.0, 1.499999999, 1.5], [1.0, 1.5]),  # half a period is far enough
        ([1.6, 1.0, 1.2], [1.6, 1.0]),  # back by more than half
        ([1.0, BACK, 1.01, 1.02], [1.0, 1.01]),  # a simulator that starts again
        ([10.0, BACK, AHEAD, 10.1, BACK, AHEAD, 10.2], [10.0]),  # two clocks that fight
    ],
)
def test_a_row_is_due_once_a_period_whatever_timer_and_clock_do(
    events: list[float | str], expected: list[float]
) -> None:
    fired = [event if isinstance(event, str) else round(event * SECOND) for event in events]
    assert rows(RowTimes(SECOND), fired) == [round(second * SECOND) for second in expected]


def firings_of_the_rule(start: int, clock: Sequence[int]) -> list[int]:
    """The timer by its words, a step of the clock's smallest unit at a time."""
    called = start
    due = next(at for at in range(start + 1, start + PERIOD + 1) if at % PERIOD == 0)
    fired = []
    for now in clock:
        if now < called:  # to before the latest call: a period from here
            called, due = now, now + PERIOD
        if now >= due:
            fired.append(now)
            called = now
            while due <= now:  # calls that were missed are skipped
                due += PERIOD
    return fired


@given(STARTS, CLOCKS)
def test_rows_are_the_timers_calls_that_the_nodes_guard_lets_through(
    start: int, clock: list[int]
) -> None:
    called = [clock[:end] for end in range(1, len(clock) + 1)]
    fires = [
        len(firings_of_the_rule(start, c)) > len(firings_of_the_rule(start, c[:-1])) for c in called
    ]
    events: list[Event] = []
    before = start
    for now, is_called in zip(clock, fires, strict=True):
        if 2 * (now - before) >= PERIOD:
            events.append(AHEAD)
        if 2 * (before - now) >= PERIOD:
            events.append(BACK)
        before = now
        events += [now] if is_called else []
    schedule = RowSchedule(PERIOD, start)
    assert [now for now in clock if schedule.is_due(now)] == rows_of_the_rule(events, PERIOD)


@pytest.mark.parametrize(
    ("start", "clock", "expected"),
    [
        (0.0, [0.5, 0.99, 1.0, 1.01, 1.9, 2.0], [1.0, 2.0]),
        (100.3, [100.9, 101.0, 102.0], [101.0, 102.0]),
        (0.0, [1.0, 2.0, 3602.5, 3603.0], [1.0, 2.0, 3602.5, 3603.0]),  # one row for an hour
        (0.0, [1.0, 2.0, 0.0, 0.9, 1.0], [1.0, 2.0, 1.0]),  # starts again
        (0.0, [1.0, 1.4, 0.6, 1.5, 1.6], [1.0, 1.6]),  # back before the latest call
        (0.0, [1.0, 1.9, 1.2, 2.0], [1.0, 2.0]),  # back, but not so far
        # A late row, then back by half a period or more: the same second has another row,
        (0.0, [1.7, 0.8, 1.1, 1.4, 1.7, 1.9], [1.7, 1.9]),
        (0.0, [1.7, 1.35, 0.86, 1.2, 1.5, 1.86], [1.7]),  # unless it was less,
        (0.0, [1.7, 0.8, 1.3, 1.6, 1.85], [1.7]),  # or the clock leaps by half a period in between,
    ],
)
def test_rows_of_a_clock(start: float, clock: list[float], expected: list[float]) -> None:
    schedule = RowSchedule(SECOND, round(start * SECOND))
    assert [now for now in clock if schedule.is_due(round(now * SECOND))] == expected
