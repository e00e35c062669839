"""What a journey adds up, on a rig that goes where it is told and odometry that says what it is told."""

import cmath
import math
from types import SimpleNamespace

import numpy as np
import pytest

from harness.robots import RoverSpec
from harness.samples import Odometry, Twist
from harness.validate import square
from harness.validate.rig import Stance
from tests.support.rovers import LEO, ROVER_ZERO4WD

HEADING = 0.5  # [rad] of the course in the world


class Route:
    """A rig that turns on the spot, drives an arc and reverses, 0.01 s a tick."""

    def __init__(self) -> None:
        self.rover, self.heading, self.simulation = LEO, HEADING, None
        self.stance = Stance(1.0, 2.0, HEADING)

    def go(self, speed: float, rate: float, ticks: int, journey: square.Journey) -> None:
        for _ in range(ticks):
            now = self.stance
            step = 0.01 * speed * cmath.exp(1j * (now.yaw - HEADING))
            self.stance = Stance(now.ahead + step.real, now.aside + step.imag, now.yaw + 0.01 * rate)
            journey.observe()


@pytest.fixture
def told(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Odometry that says 0.3 m/s and 2 rad/s at x = 3 m, y = 4 m; and with which period it is read."""
    periods: list[int] = []

    def make(_simulation: object, ticks: int) -> SimpleNamespace:
        periods.append(ticks)
        return SimpleNamespace(read=lambda: Odometry(0, 3.0, 4.0, 0.0, Twist(0.3, 2.0)))

    monkeypatch.setattr(square, "WheelOdometry", make)
    return periods


def test_the_true_way_is_counted_along_the_heading_and_turns_without_wrapping(told: list[int]) -> None:
    route = Route()
    journey = square.Journey(route)  # type: ignore[arg-type]

    route.go(0.5, 0.0, 100, journey)
    route.go(0.0, 2.0, 500, journey)
    route.go(-0.2, 0.0, 100, journey)

    assert journey.true_path == pytest.approx(0.5 - 0.2)
    assert journey.true_yaw == pytest.approx(10.0)
    assert journey.true_place == pytest.approx(0.5 - 0.2 * cmath.exp(10j))
    # LEO's odometry comes at 20 Hz: 140 readings in 7 s.
    assert told == [5]
    assert journey.told_path == pytest.approx(0.3 * 7.0)
    assert journey.told_yaw == pytest.approx(2.0 * 7.0)
    assert journey.told_place == 3 + 4j


def test_a_square_with_right_corners_closes_and_one_with_wide_ones_does_not() -> None:
    assert square._open_polygon(2.0, math.pi / 2) == pytest.approx(0.0)
    assert square._open_polygon(2.0, 0.0) == pytest.approx(8.0)
    corners = np.cumsum([0.0, 1.1, 1.1, 1.1])
    expected = complex(2.0 * np.cos(corners).sum(), 2.0 * np.sin(corners).sum())
    assert square._open_polygon(2.0, 1.1) == pytest.approx(expected)


@pytest.mark.parametrize(("rover", "believed"), [(LEO, 1.0), (ROVER_ZERO4WD, 0.122 / 0.127)])
def test_what_is_told_is_judged_by_the_yaw_ratio_and_the_believed_radius(
    rover: RoverSpec, believed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    journey = SimpleNamespace(
        told_path=8.2,
        true_path=8.0,
        told_yaw=11.0,
        true_yaw=2 * math.pi,
        told_place=1 + 1j,
        true_place=1j,
    )
    monkeypatch.setattr(square, "Rig", lambda *_: None)
    monkeypatch.setattr(square, "_drive_square", lambda _: journey)

    yaw, path, place = square.checks(rover, 0)

    low, high = {"leo": (1 / 1.76 - 0.03, 1 / 1.76 + 0.03)}.get(rover.name, (0.3, 0.24 / 0.36))
    assert (yaw.measured, yaw.expected.low, yaw.expected.high) == pytest.approx(
        (11.0 / (2 * math.pi), 1 / high, 1 / low)
    )
    assert (path.measured, path.expected.low, path.expected.high) == pytest.approx(
        (8.2 / 8.0, believed, 1.03 * believed)
    )
    # The true corners close the square; the told ones leave its end where four turned sides do.
    sides = 8.2 / 4 * np.exp(1j * 11.0 / 4 * np.arange(4))
    assert place.measured == pytest.approx(1.0)
    assert (place.expected.low, place.expected.high) == pytest.approx(
        (abs(sides.sum()) - 0.3, abs(sides.sum()) + 0.3)
    )
