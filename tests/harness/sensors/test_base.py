import pytest

from harness.errors import UsageError
from harness.sensors.base import period_ticks


@pytest.mark.parametrize(("rate", "ticks"), [(100, 1), (50, 2), (20, 5), (1, 100)])
def test_rate_that_divides_the_clock_gives_whole_ticks(rate: int, ticks: int) -> None:
    assert period_ticks(rate) == ticks


def test_other_rate_is_refused_with_the_nearest_ones() -> None:
    with pytest.raises(UsageError, match=r"30 Hz does not divide the 100 Hz clock.*20 or 25"):
        period_ticks(30)


@pytest.mark.parametrize("rate", [0, -20, 200])
def test_rate_outside_the_clocks_is_refused(rate: int) -> None:
    with pytest.raises(UsageError, match="nearest valid"):
        period_ticks(rate)
