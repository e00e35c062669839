import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import period_ticks


@pytest.mark.parametrize(
    ("rate", "ticks"),
    [(100, 1), (50, 2), (25, 4), (20, 5), (10, 10), (5, 20), (4, 25), (2, 50), (1, 100)],
)
def test_a_rate_that_divides_the_clock_gives_whole_ticks(rate: int, ticks: int) -> None:
    assert period_ticks(rate) == ticks


@pytest.mark.parametrize(
    ("rate", "nearest"),
    [(30, "20 or 25"), (40, "25 or 50"), (0, "1 or 2"), (-20, "1 or 2"), (200, "50 or 100")],
)
def test_any_other_rate_is_refused_with_the_two_nearest(rate: int, nearest: str) -> None:
    told = f"rate {rate} Hz does not divide the 100 Hz clock; nearest valid: {nearest}"
    with pytest.raises(UsageError) as refusal:
        period_ticks(rate)
    assert str(refusal.value) == told
