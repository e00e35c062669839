from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.health import watches
from rover_metrics.health.watches import MISSING, Finding, Silence, SilenceWatch, StampWatch

SECOND = 10**9
PERIOD = 50_000_000  # ns
START = 1_737_000_000 * SECOND
BEGUN, OVER = False, True
JUMPED, NO_STAMP, BACK = (watches.JUMPED_AHEAD, 1), (watches.NO_STAMP, 1), (watches.WENT_BACK, 1)


def changes_of_the_rule(looks: Sequence[tuple[int, int]], limit: int) -> list[Silence | None]:
    """The rule by its words, over all looks so far: count and time in seconds."""
    told: list[Silence | None] = []
    quiet, silent, previous = 0, False, (0, looks[0][1])
    for count, now in looks:
        quiet += sorted((0, now - previous[1], 2))[1]  # a leap is no silence
        change = None
        if count != previous[0]:
            change = Silence(OVER, quiet) if silent else None
            quiet, silent = 0, False
        elif limit and quiet >= limit and not silent:
            change, silent = Silence(BEGUN, quiet), True
        told.append(change)
        previous = count, now
    return told


@given(
    st.lists(st.tuples(st.integers(0, 2), st.integers(-1, 3)), min_size=1, max_size=60),
    st.integers(0, 6),
)
def test_begin_and_end_of_a_silence_are_the_rules(steps: list[tuple[int, int]], limit: int) -> None:
    looks, now = [], 0
    for count, passed in steps:
        now += passed
        looks.append((count // 2, now))  # mostly the same count
    watch, silent = SilenceWatch(), False
    for (count, at), expected in zip(looks, changes_of_the_rule(looks, limit), strict=True):
        assert watch.look(count, at * SECOND, limit * SECOND) == expected
        silent = silent if expected is None else not expected.is_over
        assert watch.is_silent is silent


def after(watch: StampWatch, *intervals_ns: int) -> list[Finding | None]:
    """Give messages, each so long after the one before."""
    return [watch.take(watch.latest_ns + interval) for interval in intervals_ns]


def watching(period_ns: int = PERIOD, intervals: int = 20) -> StampWatch:
    """A watch that has learnt from an even stream."""
    watch = StampWatch()
    assert watch.take(START) is None
    assert not any(after(watch, *[period_ns] * intervals))
    watch.learn()
    return watch


@pytest.mark.parametrize(
    ("intervals_ns", "finding"),
    [
        ([PERIOD] * 500, None),
        ([85_000_000], None),  # 1.7 periods: stamps jitter
        ([85_000_001], (MISSING, 1)),
        ([124_999_999], (MISSING, 1)),
        ([125_000_000], (MISSING, 2)),  # 2.5: half and more is one more
        ([10 * SECOND], (MISSING, 199)),
        ([10 * SECOND + 1], JUMPED),
        ([0], (watches.STANDS_STILL, 1)),
        ([-1], BACK),
        ([-20 * PERIOD - START, 0], NO_STAMP),
        ([-10 * PERIOD, PERIOD], None),  # goes on from where it went
        ([3600 * SECOND, 2 * PERIOD], (MISSING, 1)),
    ],
)
def test_a_step_between_stamps_tells_what_is_odd(
    intervals_ns: list[int], finding: Finding | None
) -> None:
    assert after(watching(), *intervals_ns)[-1] == finding


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(-7_000_000, 7_000_000)), max_size=60))
def test_losses_of_a_stream_that_jitters_are_counted_exactly(heard: list[tuple[int, int]]) -> None:
    watch = watching()
    number, missing = 0, 0
    for lost, jitter in heard:
        number += 1 + lost
        finding = watch.take(START + (20 + number) * PERIOD + jitter)
        assert finding is None or finding[0] == MISSING
        missing += 0 if finding is None else finding[1]
    assert missing == sum(lost for lost, _ in heard)


@pytest.mark.parametrize(("intervals", "period"), [(7, None), (8, PERIOD)])
def test_eight_intervals_tell_a_period(intervals: int, period: int | None) -> None:
    watch = watching(intervals=intervals - 1)
    after(watch, -PERIOD, PERIOD)  # what was learnt before a step back is kept
    watch.learn()
    assert watch.period_ns == period
    assert after(watch, 4 * PERIOD) == [(MISSING, 3) if period else None]
    assert after(watching(intervals=2), 10 * SECOND, 10 * SECOND + 1) == [None, JUMPED]


def test_the_period_is_the_median_of_the_latest_64_intervals() -> None:
    watch = StampWatch()
    after(watch, SECOND, *[3 * PERIOD] * 100, *[PERIOD] * 31, *[2 * PERIOD] * 32)
    for period in (2 * PERIOD, 1.5 * PERIOD):
        watch.learn()
        assert watch.period_ns == period
        after(watch, PERIOD)


def test_odd_steps_teach_no_period_but_those_of_a_slower_sensor_do() -> None:
    watch = watching()
    after(watch, *[-PERIOD, 0, 3600 * SECOND] * 30)
    watch.learn()
    assert watch.period_ns == PERIOD
    assert set(after(watch, *[4 * PERIOD] * 21)) == {(MISSING, 3)}
    watch.learn()
    assert watch.period_ns == 4 * PERIOD
    assert not any(after(watch, *[4 * PERIOD] * 100))


def test_a_sensor_that_never_stamps_is_named() -> None:
    watch = StampWatch()
    assert watch.latest_ns == 0
    assert [watch.take(0) for _ in range(3)] == [NO_STAMP] * 3
    assert watch.take(5) is None
    assert watch.latest_ns == 5
    assert [watch.take(stamp) for stamp in (0, START)] == [BACK, JUMPED]
