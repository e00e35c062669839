"""The DiffDrive controller: what its wheels do from tick to tick, in closed form."""

import math

import numpy as np
import pytest
from harness.physics.diff_drive import DiffDrive
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO, ROVER_ZERO4WD

PERIOD = 0.01
# Believed radius [m] and separation [m], limits [m/s^2] and [rad/s^2], of RoboTerrain's DiffDrive.
CONTROLLERS = [(LEO, 0.0625, 0.358, 2.5, 3.0), (ROVER_ZERO4WD, 0.122, 0.24, 5.0, 4.0)]
BOTH = pytest.mark.parametrize(
    ("rover", "radius", "separation", "acceleration", "turning"),
    CONTROLLERS,
    ids=["leo", "rover_zero4wd"],
)


def wheels(linear: float, angular: float, radius: float, separation: float) -> NDArray[np.float64]:
    left, right = linear - angular * separation / 2, linear + angular * separation / 2
    return np.array([left, left, right, right]) / radius


@BOTH
def test_speed_and_yaw_rate_rise_and_fall_by_their_limits_and_then_hold(
    rover: RoverSpec, radius: float, separation: float, acceleration: float, turning: float
) -> None:
    """0 -> up, back through zero to down, and rest; a command holds without a time-out."""
    drive = DiffDrive(rover, PERIOD)
    assert drive.wheel_speeds().tolist() == [0.0] * 4
    linear, angular = np.float64(0.0), np.float64(0.0)
    for command in (Twist(0.333, -1.234), Twist(-0.4, 0.7), Twist(0.0, 0.7), Twist()):
        assert drive.command(command)
        ticks = np.arange(1, 101) * PERIOD
        way, turn = command.linear - linear, command.angular - angular
        ramp = linear + np.sign(way) * np.minimum(acceleration * ticks, abs(way))
        bend = angular + np.sign(turn) * np.minimum(turning * ticks, abs(turn))
        for now, rate in zip(ramp, bend, strict=True):
            expected = wheels(now, rate, radius, separation)
            np.testing.assert_allclose(drive.wheel_speeds(), expected, atol=1e-12)
        linear, angular = ramp[-1], bend[-1]
    for _ in range(1000):
        drive.wheel_speeds()
    np.testing.assert_allclose(drive.wheel_speeds(), 0.0, atol=1e-12)


def test_the_limits_are_of_time_not_of_calls() -> None:
    drive = DiffDrive(LEO, 0.02)
    drive.command(Twist(1.0, 0.0))
    assert drive.wheel_speeds()[0] * 0.0625 == pytest.approx(0.05)


@pytest.mark.parametrize(
    "twist", [Twist(math.nan, 0.0), Twist(0.0, math.inf), Twist(-math.inf, math.nan)]
)
def test_a_command_that_is_not_finite_is_refused_and_the_previous_one_stays(twist: Twist) -> None:
    drive = DiffDrive(LEO, PERIOD)
    assert drive.command(Twist(0.2, 0.1))
    assert not drive.command(twist)
    for _ in range(100):
        speeds = drive.wheel_speeds()
    np.testing.assert_allclose(speeds, wheels(0.2, 0.1, 0.0625, 0.358))
