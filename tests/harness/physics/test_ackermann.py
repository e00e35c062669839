"""The Ackermann controller: wheels that roll about one centre, by the geometry of circles."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from harness.physics.ackermann import Ackermann, curvature_of
from harness.physics.diff_drive import DiffDrive
from numpy.typing import NDArray

from harness.physics.base_controller import base_controller
from harness.robots import RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO

PERIOD = 0.01
HALF, LENGTH, RADIUS = 0.2413 / 2, 0.3302, 0.0508  # of the buggy


@pytest.fixture
def buggy(foreign: Callable[[str], RoverSpec]) -> RoverSpec:
    return foreign("buggy")


def settled(rover: RoverSpec, linear: float, angular: float) -> NDArray[np.float64]:
    controller = Ackermann(rover, PERIOD)
    assert controller.command(Twist(linear, angular))
    for _ in range(1000):
        commands = controller.wheel_speeds()
    return commands


@pytest.mark.parametrize(("linear", "angular"), [(1.0, 0.9), (0.5, -0.4), (-0.6, 0.5), (2.0, 0.0)])
def test_every_wheel_rolls_about_one_centre(linear: float, angular: float, buggy: RoverSpec) -> None:
    """The centre is beside the rear axle, at v / w; a wheel's speed is w times its distance to it."""
    rear_left, rear_right, left, right = settled(buggy, linear, angular)
    if angular == 0.0:
        assert (rear_left, rear_right) == pytest.approx((linear / RADIUS,) * 2)
        assert (left, right) == (0.0, 0.0)
        return
    centre = linear / angular
    assert rear_left * RADIUS == pytest.approx(angular * (centre - HALF))
    assert rear_right * RADIUS == pytest.approx(angular * (centre + HALF))
    for angle, aside in ((left, HALF), (right, -HALF)):  # the axle points to the centre
        to_centre = np.array([-LENGTH, centre - aside])
        assert abs(to_centre @ (math.cos(angle), math.sin(angle))) < 1e-9
    assert curvature_of([left, right], LENGTH, 2 * HALF) == pytest.approx(angular / linear)


def test_no_wheel_is_asked_to_turn_further_than_it_can(buggy: RoverSpec) -> None:
    for linear, angular in ((0.3, 50.0), (0.0, -1.0)):
        commands = settled(buggy, linear, angular)
        assert np.abs(commands[2:]).max() == pytest.approx(0.4189)
        assert np.sign(commands[2]) == np.sign(angular)
    assert commands[:2].tolist() == [0.0, 0.0]  # steers and does not move


def test_steering_takes_its_time_and_stays_where_it_is_while_nothing_is_commanded(
    buggy: RoverSpec,
) -> None:
    controller = Ackermann(buggy, PERIOD)
    controller.command(Twist(1.0, 1.0))
    first, second = (controller.wheel_speeds() for _ in range(2))
    inner = [
        math.atan2(LENGTH * k, 1 - HALF * k)
        for k in (math.tan(3.2 * PERIOD * n) / LENGTH for n in (1, 2))
    ]
    assert (first[2], second[2]) == pytest.approx(inner)
    assert first[0] < second[0] < 1.0 / RADIUS
    controller.command(Twist())
    stopped = [controller.wheel_speeds() for _ in range(50)][-1]
    assert stopped[:2].tolist() == [0.0, 0.0]
    assert stopped[2] == second[2]


def test_a_command_that_is_not_finite_is_refused(buggy: RoverSpec) -> None:
    controller = Ackermann(buggy, PERIOD)
    assert not controller.command(Twist(math.nan, 0.0))
    assert not controller.command(Twist(0.0, math.inf))
    assert not controller.wheel_speeds().any()


def test_the_drive_chooses_the_controller(buggy: RoverSpec) -> None:
    assert isinstance(base_controller(LEO, PERIOD), DiffDrive)
    assert isinstance(base_controller(buggy, PERIOD), Ackermann)


def test_six_wheels_are_commanded_side_by_side(foreign: Callable[[str], RoverSpec]) -> None:
    drive = DiffDrive(foreign("sojourner"), 1.0)
    drive.command(Twist(0.2, 0.3))
    left, right = (0.2 - 0.3 * 0.2) / 0.065, (0.2 + 0.3 * 0.2) / 0.065
    assert drive.wheel_speeds() == pytest.approx(np.array([left] * 3 + [right] * 3))
