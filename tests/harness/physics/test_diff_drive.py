import math

import numpy as np
import pytest

from harness.physics.diff_drive import DiffDrive
from harness.samples import Twist
from tests.support.rovers import LEO, ROVER_ZERO4WD

PERIOD = 0.01


def settled(drive: DiffDrive) -> np.ndarray:
    for _ in range(1000):
        speeds = drive.wheel_speeds()
    return speeds


def test_straight_command_turns_all_wheels_by_the_controllers_radius() -> None:
    drive = DiffDrive(ROVER_ZERO4WD, PERIOD)
    drive.command(Twist(linear=0.5))
    np.testing.assert_allclose(settled(drive), 0.5 / 0.122)


def test_left_turn_runs_right_wheels_forward_by_the_controllers_separation() -> None:
    drive = DiffDrive(LEO, PERIOD)
    drive.command(Twist(angular=1.0))
    side = 0.5 * 0.358 / 0.0625
    np.testing.assert_allclose(settled(drive), [-side, -side, side, side])


def test_acceleration_is_limited_to_the_rovers() -> None:
    drive = DiffDrive(LEO, PERIOD)
    drive.command(Twist(linear=1.0))
    first = drive.wheel_speeds()[0] * LEO.controller_radius
    assert first == pytest.approx(LEO.linear_acceleration * PERIOD)
    drive.command(Twist(linear=-1.0))
    assert drive.wheel_speeds()[0] == pytest.approx(0.0)


@pytest.mark.parametrize("twist", [Twist(math.nan, 0.0), Twist(0.0, math.inf)])
def test_non_finite_command_is_refused_and_the_previous_one_stays(twist: Twist) -> None:
    drive = DiffDrive(LEO, PERIOD)
    assert drive.command(Twist(linear=0.2))
    assert not drive.command(twist)
    np.testing.assert_allclose(settled(drive), 0.2 / 0.0625)


def test_command_is_latched_without_timeout() -> None:
    drive = DiffDrive(LEO, PERIOD)
    drive.command(Twist(linear=0.3))
    assert settled(drive)[0] == pytest.approx(settled(drive)[0])
    assert settled(drive)[0] > 0
