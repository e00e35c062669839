"""When rows come, live, as /clock goes on and of recordings, against the rules in their own words.

rcl_timer_call and _rcl_timer_time_jump of rcl/timer.c; JumpThreshold as row_timer.py registers it.
"""

from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.timing import ClockRows, FullSeconds, RowSchedule, RowTimes, age, rate

SECOND = 10**9
DAY = 86_400 * SECOND
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
def test_rows_are_the_timers_calls_that_the_guard_lets_through(start: int, clock: list[int]) -> None:
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


def due(timer: FullSeconds | ClockRows, *times: float) -> list[int]:
    return [at_ns // SECOND for t in times for at_ns in timer.due(round(t * SECOND))]


@pytest.mark.parametrize(
    ("times", "seconds", "rest", "jumps"),
    [
        ([0.5, 3.2, 3.1, 3.9], [1, 2, 3], [], []),
        ([0.5, 1.0, 1.0], [], [1], []),  # a second is full when something comes after it
        ([5.0, 5.0, 5.5, 6.5], [6], [], []),  # of the second that ends there nothing was heard
        ([0.9, 1.01, 0.99, 1.02, 2.01], [1, 2], [], []),  # late by less than a second
        ([2.5, 1.5, 2.6], [], [], []),  # late by a second, which is late still
        ([2.5, 1.4, 2.6], [2], [], ["time jumps from 2.50 s to 1.40 s"]),
        ([3.5, 2.0, 2.0, 3.5], [3], [], ["time jumps from 3.50 s to 2.00 s"]),
        ([0.5, 60.5], list(range(1, 61)), [], []),
        ([0.5, 61.0], list(range(1, 61)), [61], []),
        ([0.5, 61.5], [61], [], ["time jumps from 0.50 s to 61.50 s"]),
        ([], [], [], []),
        ([3.9, 64.5, 0.0, 0.9, 1.0, 2.0], [64, 1], [2], None),
    ],
)
def test_each_full_second_has_a_row_and_each_jump_a_line(
    times: list[float], seconds: list[int], rest: list[int], jumps: list[str] | None
) -> None:
    timer = FullSeconds()
    assert due(timer, *times) == seconds
    assert timer.rest() == [second * SECOND for second in rest]
    expected = ["time jumps from 3.90 s to 64.50 s", "time jumps from 64.50 s to 0.00 s"]
    assert timer.jumps == (expected if jumps is None else jumps)


@given(st.lists(st.integers(0, 12), min_size=1, max_size=15), st.integers(0, 8))
def test_rows_are_the_full_seconds_between_first_and_last(steps: list[int], start: int) -> None:
    quarters = [start + sum(steps[:end]) for end in range(len(steps))]
    timer = FullSeconds()
    told = due(timer, *(quarter / 4 for quarter in quarters))
    full = [second for second in range(100) if quarters[0] < 4 * second <= quarters[-1]]
    assert [*told, *(at_ns // SECOND for at_ns in timer.rest())] == full


def test_rows_on_the_clock_topic_are_the_nodes_and_its_jumps_are_told() -> None:
    timer = ClockRows()
    assert due(timer, 0.01, 0.99, 1.0, 1.01, 1.5, 2.0) == [1, 2]
    assert due(timer, 5.5, 5.9, 6.0) == [5, 6]
    assert due(timer, 3.25, 4.0, 4.2, 4.25) == [4]
    assert due(timer, 5.25, 4.25) == [5]  # a second is no jump
    assert timer.jumps == ["time jumps from 2.00 s to 5.50 s", "time jumps from 6.00 s to 3.25 s"]
    assert timer.rest() == []
    assert timer.due(round(6.25 * SECOND)) == [round(6.25 * SECOND)]
    assert due(ClockRows(), 100.3, 100.9, 101.0, 102.0) == [101, 102]  # begins amid a run


def test_a_stamp_is_as_old_as_it_is_unless_it_is_of_no_clock_or_of_another() -> None:
    for now_ns, stamp_ns, seconds in (
        (5 * SECOND, 3 * SECOND, 2.0),
        (5 * SECOND, 6 * SECOND, -1.0),  # a stamp of a clock that is ahead
        (5 * SECOND, 0, None),  # never set
        (DAY + 1, 1, 86_400.0),
        (DAY + 200, 1, None),  # another clock
        (1, DAY + 1, -86_400.0),
        (1, DAY + 200, None),
    ):
        assert age(now_ns, stamp_ns) == seconds


def test_a_rate_is_over_the_time_that_has_passed_if_any_has() -> None:
    assert rate(40, 3 * SECOND, 5 * SECOND) == 20.0
    assert rate(1, 0, SECOND // 2) == 2.0
    assert [rate(1, since, SECOND) for since in (None, SECOND, 2 * SECOND)] == [None] * 3
