import pytest

from harness.pacing import Pacer

SECOND = 1_000_000_000


class FakeTime:
    def __init__(self) -> None:
        self.now_ns = 5 * SECOND
        self.slept: list[float] = []

    def clock(self) -> int:
        return self.now_ns

    def sleep(self, seconds: float) -> None:
        self.slept.append(seconds)
        self.now_ns += round(seconds * SECOND)


def test_real_time_waits_for_the_difference() -> None:
    time = FakeTime()
    pacer = Pacer(1.0, time.clock, time.sleep)
    time.now_ns += SECOND // 4
    pacer.wait_until(SECOND)
    assert time.slept == [pytest.approx(0.75)]


def test_a_late_run_does_not_wait() -> None:
    time = FakeTime()
    pacer = Pacer(2.0, time.clock, time.sleep)
    time.now_ns += SECOND
    pacer.wait_until(SECOND)
    assert time.slept == []


def test_double_rate_waits_half_as_long() -> None:
    time = FakeTime()
    Pacer(2.0, time.clock, time.sleep).wait_until(SECOND)
    assert time.slept == [pytest.approx(0.5)]


def test_max_never_waits() -> None:
    time = FakeTime()
    Pacer(None, time.clock, time.sleep).wait_until(1000 * SECOND)
    assert time.slept == []
