"""The controllers of the base: ramps in closed form, and wheels that roll about one centre."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.physics.base_controller import BaseController, base_controller, curvature_of
from harness.robots import ROVERS, RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO

PERIOD = 0.01
HALF, LENGTH, RADIUS = 0.2413 / 2, 0.3302, 0.0508  # of the buggy
Foreign = Callable[[str], RoverSpec]


def skid(rover: RoverSpec, linear: float, angular: float) -> NDArray[np.float64]:
    """Wheel speeds by the rover's own belief of its wheels [rad/s]."""
    half = angular * rover.controller_separation / 2
    count = len(rover.drive.driven) // 2
    return np.repeat([linear - half, linear + half], count) / rover.controller_radius


def after(controller: BaseController, calls: int) -> NDArray[np.float64]:
    return [controller.wheel_speeds() for _ in range(calls)][-1]


@pytest.mark.parametrize("name", [*ROVERS, "sojourner"])
def test_speed_and_yaw_rate_rise_and_fall_by_their_limits_and_then_hold(
    name: str, foreign: Foreign
) -> None:
    """0 -> up, back through zero to down, and rest; a command holds without a time-out."""
    rover = ROVERS[name] if name in ROVERS else foreign(name)
    drive = base_controller(rover, PERIOD)
    assert not drive.wheel_speeds().any()
    linear, angular = np.float64(0.0), np.float64(0.0)
    for command in (Twist(0.333, -1.234), Twist(-0.4, 0.7), Twist(0.0, 0.7), Twist()):
        assert drive.command(command)
        ticks = np.arange(1, 101) * PERIOD
        way, turn = command.linear - linear, command.angular - angular
        ramp = linear + np.sign(way) * np.minimum(rover.linear_acceleration * ticks, abs(way))
        bend = angular + np.sign(turn) * np.minimum(rover.angular_acceleration * ticks, abs(turn))
        for now, rate in zip(ramp, bend, strict=True):
            np.testing.assert_allclose(drive.wheel_speeds(), skid(rover, now, rate), atol=1e-12)
        linear, angular = ramp[-1], bend[-1]
    np.testing.assert_allclose(after(drive, 1000), 0.0, atol=1e-12)


@pytest.mark.parametrize("name", ["leo", "buggy"])
@pytest.mark.parametrize("bad", [(math.nan, 0.0), (0.0, math.inf), (-math.inf, math.nan)])
def test_a_command_that_is_not_finite_is_refused_and_the_previous_one_stays(
    bad: tuple[float, float], name: str, foreign: Foreign
) -> None:
    rover = LEO if name == "leo" else foreign(name)
    drive, same = base_controller(rover, PERIOD), base_controller(rover, PERIOD)
    assert drive.command(Twist(0.2, 0.1))
    assert same.command(Twist(0.2, 0.1))
    assert not drive.command(Twist(*bad))
    assert np.array_equal(after(drive, 100), after(same, 100))


@pytest.mark.parametrize(("linear", "angular"), [(1.0, 0.9), (0.5, -0.4), (-0.6, 0.5), (2.0, 0.0)])
def test_every_wheel_rolls_about_one_centre(linear: float, angular: float, foreign: Foreign) -> None:
    """The centre is beside the rear axle, at v / w; a wheel's speed is w times its distance to it."""
    buggy, twist = foreign("buggy"), Twist(linear, angular)
    four = buggy.but(drive=buggy.drive.but(driven=(*buggy.drive.driven, *buggy.steered_wheels)))
    controllers = base_controller(buggy, PERIOD), base_controller(four, PERIOD)
    assert all(controller.command(twist) for controller in controllers)
    (rear_left, rear_right, left, right), all_driven = (after(each, 1000) for each in controllers)
    assert all_driven[[0, 1, 4, 5]].tolist() == [rear_left, rear_right, left, right]
    if angular == 0.0:
        assert (rear_left, rear_right, left, right) == pytest.approx((linear / RADIUS,) * 2 + (0.0, 0.0))
        return
    centre = linear / angular
    assert rear_left * RADIUS == pytest.approx(angular * (centre - HALF))
    assert rear_right * RADIUS == pytest.approx(angular * (centre + HALF))
    fronts = zip(all_driven[2:4], (left, right), (HALF, -HALF), strict=True)
    for speed, angle, aside in fronts:  # the axle points to the centre
        to_centre = np.array([-LENGTH, centre - aside])
        assert abs(speed) * RADIUS == pytest.approx(abs(angular) * np.hypot(*to_centre))
        assert abs(to_centre @ (math.cos(angle), math.sin(angle))) < 1e-9
    assert curvature_of([left, right], LENGTH, 2 * HALF) == pytest.approx(angular / linear)


@pytest.mark.parametrize(("linear", "angular"), [(0.3, 50.0), (0.0, -1.0)])
def test_no_wheel_is_asked_to_turn_further_than_it_can(
    linear: float, angular: float, foreign: Foreign
) -> None:
    controller = base_controller(foreign("buggy"), PERIOD)
    controller.command(Twist(linear, angular))
    commands = after(controller, 1000)
    assert np.abs(commands[2:]).max() == pytest.approx(0.4189)
    assert np.sign(commands[2]) == np.sign(angular)
    assert commands[:2].any() == bool(linear)  # without speed it steers and does not move


def test_steering_takes_its_time_and_stays_where_it_is_while_nothing_is_commanded(
    foreign: Foreign,
) -> None:
    controller = base_controller(foreign("buggy"), PERIOD)
    controller.command(Twist(1.0, 1.0))
    first, second = (controller.wheel_speeds() for _ in range(2))
    curvatures = [math.tan(3.2 * PERIOD * n) / LENGTH for n in (1, 2)]
    inner = [math.atan2(LENGTH * k, 1 - HALF * k) for k in curvatures]
    assert (first[2], second[2]) == pytest.approx(inner)
    assert first[0] < second[0] < 1.0 / RADIUS
    controller.command(Twist())
    stopped = after(controller, 50)
    assert stopped[:2].tolist() == [0.0, 0.0]
    assert stopped[2] == second[2]
