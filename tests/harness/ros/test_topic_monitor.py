import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from harness.ros.topic_monitor import WINDOW, Pace


def noted(*points: tuple[float, float]) -> Pace:
    pace = Pace()
    for now, value in points:
        pace.note(now, value)
    return pace


@pytest.mark.parametrize(
    ("points", "now", "rate"),
    [
        ([(0.0, 0.0), (2.0, 5.0)], 2.0, 2.5),
        ([(0.0, 0.0), (1.0, 9.0), (2.0, 10.0)], 2.0, 5.0),
        ([(0.0, 0.0), (1.0, 10.0), (5.0, 30.0)], WINDOW, 6.0),  # what is WINDOW old still counts
        ([(0.0, 0.0), (1.0, 10.0), (5.0, 30.0)], WINDOW + 0.01, 5.0),
        ([(0.0, 0.0), (1.0, 10.0)], WINDOW + 0.5, None),
        ([(0.0, 50.0), (1.0, 3.0), (2.0, 5.0)], 2.0, 2.0),  # it fell: anew
        ([(0.0, 5.0), (1.0, 5.0)], 1.0, 0.0),  # it stands
        ([(1.0, 1.0), (1.0, 2.0)], 1.0, None),
        ([(1.0, 1.0)], 1.0, None),
    ],
)
def test_a_rate_is_growth_over_the_window(
    points: list[tuple[float, float]], now: float, rate: float | None
) -> None:
    assert noted(*points).rate(now) == (None if rate is None else pytest.approx(rate))


def test_an_age_is_that_of_the_last_value_even_outside_the_window() -> None:
    assert Pace().age(1.0) is None
    assert noted((1.0, 1.0), (2.0, 2.0)).age(20.0) == pytest.approx(18.0)


def test_memory_is_bounded_by_the_window() -> None:
    pace = noted(*((count / 100.0, count) for count in range(round(1000.0 * WINDOW) + 1)))
    assert len(pace._points) <= 100.0 * WINDOW + 1
