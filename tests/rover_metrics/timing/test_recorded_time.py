import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.timing.recorded_time import ClockRows, FullSeconds

SECOND = 10**9


def due(timer: FullSeconds | ClockRows, *times: float) -> list[int]:
    return [at_ns // SECOND for t in times for at_ns in timer.due(round(t * SECOND))]


@pytest.mark.parametrize(
    ("times", "seconds", "rest", "jumps"),
    [
        ([0.5, 3.2, 3.1, 3.9], [1, 2, 3], [], []),
        ([0.5, 1.0, 1.0], [], [1], []),  # a second is full when something comes after it
        ([0.5, 1.000000001], [1], [], []),
        ([5.0, 5.5, 6.5], [6], [], []),  # nothing was heard of the second that ends where it begins
        ([5.0, 5.0, 5.5, 6.5], [6], [], []),
        ([0.9, 1.01, 0.99, 1.02, 2.01], [1, 2], [], []),  # late by less than a second
        ([2.5, 1.5, 2.6], [], [], []),  # late by a second, which is late still
        ([2.5, 1.4, 2.6], [2], [], ["time jumps from 2.50 s to 1.40 s"]),
        ([2.5, 1.6, 1.4], [], [], ["time jumps from 2.50 s to 1.40 s"]),
        ([3.5, 2.0, 2.0, 3.5], [3], [], ["time jumps from 3.50 s to 2.00 s"]),
        ([0.5, 60.5], list(range(1, 61)), [], []),
        ([0.5, 61.0], list(range(1, 61)), [61], []),
        ([0.5, 61.5], [61], [], ["time jumps from 0.50 s to 61.50 s"]),
        ([3.9, 64.5, 0.0, 0.9, 1.0, 2.0], [64, 1], [2], None),
        ([], [], [], []),
    ],
)
def test_each_full_second_of_a_recording_has_a_row_and_a_jump_has_one_and_a_line(
    times: list[float], seconds: list[int], rest: list[int], jumps: list[str] | None
) -> None:
    timer = FullSeconds()
    assert due(timer, *times) == seconds
    assert timer.rest() == [second * SECOND for second in rest]
    expected = ["time jumps from 3.90 s to 64.50 s", "time jumps from 64.50 s to 0.00 s"]
    assert timer.jumps == (expected if jumps is None else jumps)


@given(st.lists(st.integers(0, 12), min_size=1, max_size=15), st.integers(0, 8))
def test_however_messages_come_the_rows_are_the_full_seconds_between_first_and_last(
    steps: list[int], start: int
) -> None:
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


def test_a_recording_that_begins_amid_a_run_has_its_first_row_at_a_full_second() -> None:
    assert due(ClockRows(), 100.3, 100.9, 101.0, 102.0) == [101, 102]
