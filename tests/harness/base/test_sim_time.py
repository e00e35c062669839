"""Durations and timesteps that fit the clock, and those that do not."""

import math

import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import check_duration, parse_timestep, period_ticks


@pytest.mark.parametrize(
    "seconds", [0.01, 0.02, 0.29, 2.05, 4.1, 1.0, 1.15, 3600.0, 86400.01, 1.0 + 4e-10]
)
def test_a_duration_of_whole_clock_ticks_is_accepted(seconds: float) -> None:
    check_duration(seconds)


@pytest.mark.parametrize("seconds", [0.0, -1.0, -0.01, 0.009999999, math.nan, math.inf, -math.inf])
def test_a_duration_without_a_tick_is_refused(seconds: float) -> None:
    with pytest.raises(UsageError, match=r"duration \S+ s is not valid; give 0\.01 s or more$"):
        check_duration(seconds)


@pytest.mark.parametrize(
    ("seconds", "said", "nearest"),
    [
        (0.015, "0.015", "0.01 or 0.02"),
        (0.010000001, "0.010000001", "0.01 or 0.02"),
        (59.999, "59.999", "59.99 or 60"),
        (3600.001, "3600.001", "3600 or 3600.01"),
    ],
)
def test_a_duration_between_two_ticks_is_refused_with_both(
    seconds: float, said: str, nearest: str
) -> None:
    with pytest.raises(UsageError, match=f"^duration {said} s is refused: .* nearest valid: {nearest}$"):
        check_duration(seconds)


@pytest.mark.parametrize("parts", [2, 4, 5, 8, 10, 16, 20, 25, 32, 40, 50, 64, 80, 100])
def test_every_timestep_that_divides_the_tick_is_accepted(parts: int) -> None:
    for seconds in (0.01 / parts, math.nextafter(0.01 / parts, 0.0)):
        assert parse_timestep(seconds) == 10_000_000 // parts


@pytest.mark.parametrize(
    ("seconds", "reason", "nearest"),
    [
        (0.003, "it must divide the 10 ms clock tick", "0.0025 or 0.002"),
        (0.004, "it must divide the 10 ms clock tick", "0.005 or 0.0025"),
        (0.0001000001, "", ""),  # within half a nanosecond
        (0.000101, "it must divide the 10 ms clock tick", "0.0001 or 0.000125"),
        (0.000099999, "give 0.0001 or more", "0.0001 or 0.000125"),
        (0.0, "give 0.0001 or more", "0.0001 or 0.000125"),
        (-0.0025, "give 0.0001 or more", "0.0001 or 0.000125"),
        (math.nan, "give 0.0001 or more", "0.0001 or 0.000125"),
        (math.inf, "give 0.0001 or more", "0.0001 or 0.000125"),
        (0.005000001, "above 5 ms", "0.005 or 0.0025"),
        (0.01, "above 5 ms", "0.005 or 0.0025"),
    ],
)
def test_any_other_is_refused_with_the_reason_and_the_two_nearest(
    seconds: float, reason: str, nearest: str
) -> None:
    if not reason:
        assert parse_timestep(seconds) == 100_000
        return
    told = f"^timestep {seconds:g} s is refused: {reason}.*; nearest valid: {nearest}$"
    with pytest.raises(UsageError, match=told):
        parse_timestep(seconds)


@pytest.mark.parametrize(
    ("rate", "nearest"),
    [(30, "20 or 25"), (40, "25 or 50"), (0, "1 or 2"), (-20, "1 or 2"), (200, "50 or 100")],
)
def test_a_rate_that_does_not_divide_the_clock_is_refused_with_the_two_nearest(
    rate: int, nearest: str
) -> None:
    assert [period_ticks(n) for n in (100, 25, 4, 1)] == [1, 4, 25, 100]
    with pytest.raises(UsageError, match=f"^rate {rate} Hz does not .* nearest valid: {nearest}$"):
        period_ticks(rate)
