import pytest

from harness.episode.pacing import Pacer

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


@pytest.mark.parametrize(
    ("rate", "gone_s", "waits_s"),
    [(1.0, 0.25, [0.75]), (2.0, 0.0, [0.5]), (0.5, 0.5, [1.5]), (2.0, 1.0, []), (None, 0.0, [])],
)
def test_it_waits_until_wall_time_has_caught_up_with_a_second_of_simulation(
    rate: float | None, gone_s: float, waits_s: list[float]
) -> None:
    time = FakeTime()
    pacer = Pacer(rate, time.clock, time.sleep)
    time.now_ns += round(gone_s * SECOND)
    pacer.wait_until(SECOND)
    assert time.slept == pytest.approx(waits_s)


def test_a_pause_is_not_caught_up_with() -> None:
    time = FakeTime()
    pacer = Pacer(1.0, time.clock, time.sleep)
    time.now_ns += 7 * SECOND
    pacer.postpone(7.0)
    pacer.wait_until(SECOND)
    assert time.slept == pytest.approx([1.0])
