import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.stamps import (
    JUMP,
    JUMPED_AHEAD,
    MISSING,
    NO_STAMP,
    RECENT,
    STANDS_STILL,
    WENT_BACK,
    Finding,
    StampWatch,
)

PERIOD = 50_000_000  # ns
START = 1_737_000_000 * 10**9


def taken(watch: StampWatch, *numbers: float) -> list[Finding | None]:
    """Give messages by their number in an even stream."""
    return [watch.take(START + round(number * PERIOD)) for number in numbers]


@pytest.fixture
def watch() -> StampWatch:
    """A watch that has seen messages 0 to 19."""
    watch = StampWatch()
    assert not any(taken(watch, *range(20)))
    watch.learn()
    return watch


def test_an_even_stream_is_nothing_odd(watch: StampWatch) -> None:
    assert watch.period_ns == PERIOD
    assert not any(taken(watch, *range(20, 500)))


def test_a_gap_tells_how_many_are_missing(watch: StampWatch) -> None:
    assert taken(watch, 20, 22, 23, 30, 31) == [None, (MISSING, 1), None, (MISSING, 6), None]


def test_stamps_that_jitter_are_no_gap(watch: StampWatch) -> None:
    assert not any(taken(watch, 20.3, 20.8, 22.2, 22.9, 24.4, 24.6))


def test_without_a_known_period_only_jumps_are_seen() -> None:
    watch = StampWatch()
    assert taken(watch, 0, 1, 5, 100) == [None] * 4
    watch.learn()
    assert watch.period_ns is None
    assert watch.take(START + 101 * PERIOD + JUMP) == (JUMPED_AHEAD, 1)


def test_a_stamp_that_stands_still_goes_back_or_jumps_an_hour_is_named(watch: StampWatch) -> None:
    hour = 72_000
    assert taken(watch, 19, 20, 10, 11, hour, hour + 1) == [
        (STANDS_STILL, 1),
        None,
        (WENT_BACK, 1),
        None,
        (JUMPED_AHEAD, 1),
        None,
    ]
    assert watch.period_ns == PERIOD


def test_a_sensor_that_never_stamps_is_named() -> None:
    watch = StampWatch()
    assert [watch.take(0) for _ in range(3)] == [(NO_STAMP, 1)] * 3


def test_a_sensor_that_is_slower_for_good_is_odd_only_until_the_next_look(watch: StampWatch) -> None:
    slow = [20 + 4 * number for number in range(100)]
    assert taken(watch, *slow[:3]) == [None, (MISSING, 3), (MISSING, 3)]
    taken(watch, *slow[3:64])
    watch.learn()
    assert watch.period_ns == 4 * PERIOD
    assert not any(taken(watch, *slow[64:]))


@given(st.lists(st.integers(-(2**63), 2**63), max_size=300))
def test_whatever_the_stamps_memory_is_bounded_and_counts_are_positive(stamps: list[int]) -> None:
    watch = StampWatch()
    for number, stamp in enumerate(stamps):
        finding = watch.take(stamp)
        assert finding is None or finding[1] > 0
        if number % 20 == 0:
            watch.learn()
    assert len(watch._intervals) <= RECENT
    assert all(0 < interval <= JUMP for interval in watch._intervals)
