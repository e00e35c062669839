from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.timing.row_times import RowTimes

SECOND = 10**9
PERIOD = 6  # of the model: small, so that every edge is met
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


@given(st.lists(st.integers(0, 4 * PERIOD) | st.sampled_from([BACK, AHEAD]), max_size=40))
def test_rows_segments_and_refusals_are_those_of_the_rule(events: list[Event]) -> None:
    times = RowTimes(PERIOD)
    written = rows(times, events)
    assert written == rows_of_the_rule(events, PERIOD)
    assert times.segments == 1 + events.count(BACK)
    firings = sum(isinstance(event, int) for event in events)
    assert times.suppressed == firings - len(written)


@pytest.mark.parametrize(
    ("events", "expected"),
    [
        ([1.0, 2.0, 3.0], [1.0, 2.0, 3.0]),
        ([1.0, 1.0, 1.01, 2.0, 2.0], [1.0, 2.0]),  # fires twice
        ([1.0, 2.9, 3.0, 4.0], [1.0, 2.9, 3.0, 4.0]),  # fires late
        ([1.0, 1.499999999, 1.5], [1.0, 1.5]),  # half a period is far enough
        ([1.6, 1.0, 1.2], [1.6, 1.0]),  # back by more than half
        ([1.0004, 1.9998, 3.0001, 3.9999], [1.0004, 1.9998, 3.0001, 3.9999]),  # a wall clock
        ([1.0, AHEAD, 3601.5, 3601.5, 3602.0], [1.0, 3601.5, 3602.0]),
        ([1.0, BACK, 1.01, 1.02], [1.0, 1.01]),  # a simulator that starts again
        ([10.0, BACK, AHEAD, 10.1, BACK, AHEAD, 10.2], [10.0]),  # two clocks that fight
    ],
)
def test_a_row_is_due_once_a_period_whatever_timer_and_clock_do(
    events: list[float | str], expected: list[float]
) -> None:
    fired = [event if isinstance(event, str) else round(event * SECOND) for event in events]
    assert rows(RowTimes(SECOND), fired) == [round(second * SECOND) for second in expected]
