"""Ages and rates, and when there is none."""

import pytest

from rover_metrics.timing.clocks import age, rate

SECOND = 10**9
DAY = 86_400 * SECOND


@pytest.mark.parametrize(
    ("now_ns", "stamp_ns", "seconds"),
    [
        (5 * SECOND, 3 * SECOND, 2.0),
        (5 * SECOND, 5 * SECOND, 0.0),
        (5 * SECOND, 6 * SECOND, -1.0),  # a stamp of a clock that is ahead
        (5 * SECOND, 0, None),  # never set
        (DAY + 1, 1, 86_400.0),
        (DAY + 200, 1, None),  # another clock
        (1, DAY + 1, -86_400.0),
        (1, DAY + 200, None),
    ],
)
def test_a_stamp_is_as_old_as_it_is_unless_it_is_of_no_clock_or_of_another(
    now_ns: int, stamp_ns: int, seconds: float | None
) -> None:
    assert age(now_ns, stamp_ns) == seconds


@pytest.mark.parametrize(
    ("count", "since_ns", "now_ns", "hertz"),
    [
        (40, 3 * SECOND, 5 * SECOND, 20.0),
        (0, 3 * SECOND, 5 * SECOND, 0.0),
        (1, 0, SECOND // 2, 2.0),
        (1, None, SECOND, None),
        (1, SECOND, SECOND, None),
        (1, 2 * SECOND, SECOND, None),
    ],
)
def test_a_rate_is_over_the_time_that_has_passed_if_any_has(
    count: int, since_ns: int | None, now_ns: int, hertz: float | None
) -> None:
    assert rate(count, since_ns, now_ns) == hertz
