import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.row_times import RowTimes

SECOND = 10**9


@pytest.fixture
def times() -> RowTimes:
    return RowTimes(SECOND)


def due(times: RowTimes, *seconds: float) -> list[bool]:
    return [times.is_due(round(second * SECOND)) for second in seconds]


def test_every_second_is_due(times: RowTimes) -> None:
    assert all(due(times, *range(1, 100)))
    assert times.segments == 1
    assert times.suppressed == 0


def test_a_timer_that_fires_twice_is_due_once(times: RowTimes) -> None:
    assert due(times, 1.0, 1.0, 1.01, 2.0, 2.0) == [True, False, False, True, False]
    assert times.suppressed == 3


def test_a_timer_that_fires_late_is_due_and_so_is_the_next(times: RowTimes) -> None:
    assert due(times, 1.0, 2.9, 3.0, 4.0) == [True] * 4


def test_seconds_that_end_unevenly_on_the_wall_clock_are_all_due(times: RowTimes) -> None:
    assert due(times, 1.0004, 1.9998, 3.0001, 3.9999) == [True] * 4


def test_an_hour_ahead_is_one_row(times: RowTimes) -> None:
    due(times, 1.0)
    times.leapt_ahead()
    assert due(times, 3601.5, 3601.5, 3602.0) == [True, False, True]


def test_after_a_restart_the_same_second_is_due_again(times: RowTimes) -> None:
    due(times, 1.0)
    times.went_back()
    assert due(times, 1.01) == [True]
    assert times.segments == 2


def test_two_clocks_that_fight_make_no_burst(times: RowTimes) -> None:
    due(times, 10.0)
    written = 0
    for tick in range(100):  # a second of both clocks
        times.went_back()
        times.leapt_ahead()
        written += due(times, 11.5 + tick / 100)[0]
    assert written <= 2


@given(st.lists(st.integers(0, 100 * SECOND), max_size=100))
def test_without_a_restart_two_rows_of_one_second_are_half_a_second_apart(nows: list[int]) -> None:
    times = RowTimes(SECOND)
    rows = [now for now in nows if times.is_due(now)]
    for before, after in itertools.pairwise(rows):
        assert before // SECOND != after // SECOND or abs(after - before) >= SECOND / 2
    assert len(rows) + times.suppressed == len(nows)
