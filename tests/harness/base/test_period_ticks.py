import pytest

from harness.base.errors import UsageError
from harness.base.sim_time import period_ticks


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
