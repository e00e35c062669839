"""When the node's rows come as /clock goes on, against the two rules in their own words.

rcl_timer_call and _rcl_timer_time_jump of rcl/timer.c; JumpThreshold as row_timer.py registers it.
"""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.timing.row_schedule import RosTimer, RowSchedule
from tests.rover_metrics.timing.test_row_times import AHEAD, BACK, Event, rows_of_the_rule

SECOND = 10**9
PERIOD = 6
STARTS = st.integers(0, 2 * PERIOD)
CLOCKS = st.lists(st.integers(0, 6 * PERIOD), max_size=40)


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
def test_the_timer_is_called_when_rcls_is(start: int, clock: list[int]) -> None:
    timer = RosTimer(PERIOD, start)
    assert [now for now in clock if timer.fires_at(now)] == firings_of_the_rule(start, clock)


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
        (0.0, [0.7, 1.3, 1.9, 2.5], [1.3, 2.5]),
        (100.3, [100.9, 101.0, 102.0], [101.0, 102.0]),
        (100.0, [100.0, 100.9, 101.0], [101.0]),
        (0.0, [1.0, 2.0, 3602.5, 3603.0], [1.0, 2.0, 3602.5, 3603.0]),  # one row for an hour
        (0.0, [1.0, 2.0, 0.0, 0.9, 1.0], [1.0, 2.0, 1.0]),  # starts again
        (0.0, [1.0, 1.4, 0.6, 1.5, 1.6], [1.0, 1.6]),  # back before the latest call
        (0.0, [1.0, 1.9, 1.2, 2.0], [1.0, 2.0]),  # back, but not so far
        # A late row, then back by half a period or more: the same second has another row,
        (0.0, [1.7, 0.8, 1.1, 1.4, 1.7, 1.9], [1.7, 1.9]),
        (0.0, [1.7, 1.35, 0.85, 1.2, 1.5, 1.86], [1.7, 1.86]),
        (0.0, [1.7, 1.35, 0.86, 1.2, 1.5, 1.86], [1.7]),  # unless it was less,
        (0.0, [1.7, 0.8, 1.3, 1.6, 1.85], [1.7]),  # or the clock leaps by half a period in between,
        (0.0, [1.7, 0.8, 1.29, 1.6, 1.85], [1.7, 1.85]),  # not by less.
    ],
)
def test_rows_of_a_clock(start: float, clock: list[float], expected: list[float]) -> None:
    schedule = RowSchedule(SECOND, round(start * SECOND))
    assert [now for now in clock if schedule.is_due(round(now * SECOND))] == expected
