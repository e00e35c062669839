from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.silence import Silence, SilenceWatch

SECOND = 10**9


def looks(
    watch: SilenceWatch, *counts_and_seconds: tuple[int, float], limit: float = 5.0
) -> list[Silence]:
    changes = [
        watch.look(count, round(seconds * SECOND), round(limit * SECOND))
        for count, seconds in counts_and_seconds
    ]
    return [change for change in changes if change is not None]


def test_a_silence_is_told_once_when_it_is_long_enough_and_once_when_it_is_over() -> None:
    watch = SilenceWatch()
    assert looks(watch, *((3, second) for second in range(5))) == []
    assert looks(watch, *((3, second) for second in range(5, 100))) == [Silence(False, 5.0)]
    assert looks(watch, (4, 100), (5, 101)) == [Silence(True, 100.0)]


def test_what_has_never_been_heard_is_silent_too() -> None:
    assert looks(SilenceWatch(), *((0, second) for second in range(9))) == [Silence(False, 5.0)]


def test_what_goes_on_is_never_silent() -> None:
    assert looks(SilenceWatch(), *((second, second) for second in range(1000))) == []


def test_a_count_that_starts_again_is_no_silence() -> None:
    assert looks(SilenceWatch(), (9, 0), (9, 3), (1, 4), (2, 8)) == []


def test_a_limit_of_zero_is_never() -> None:
    assert looks(SilenceWatch(), *((0, second) for second in range(999)), limit=0.0) == []


def test_a_clock_that_jumps_an_hour_or_is_reset_makes_no_silence() -> None:
    assert looks(SilenceWatch(), (1, 10), (1, 3610), (2, 3611)) == []
    assert looks(SilenceWatch(), (1, 3600), (1, 0), (1, 1), (1, 2), (1, 3), (1, 4)) == []


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(-(2**62), 2**62)), max_size=60))
def test_begin_and_end_take_turns_whatever_the_clock_does(seen: list[tuple[int, int]]) -> None:
    watch = SilenceWatch()
    changes = [watch.look(count, now, SECOND) for count, now in seen]
    ends = [change.is_over for change in changes if change is not None]
    assert ends == [bool(number % 2) for number in range(len(ends))]
