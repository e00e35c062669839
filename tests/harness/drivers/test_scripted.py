"""Fixed manoeuvres: straight, spin, figure8, and the driver that is driven."""

import math
from dataclasses import replace

import numpy as np
import pytest

from harness.drivers import DRIVERS
from harness.drivers.base import DriverContext, Observation
from harness.drivers.scripted import CmdVel
from harness.robots import RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO


def context(rover: RoverSpec = LEO) -> DriverContext:
    return DriverContext(rover, (20.0, 20.0), np.zeros(1), np.random.default_rng(0))


def at(yaw: float) -> Observation:
    return Observation(0, 0.0, 0.0, yaw, None)


def test_a_figure8_is_a_left_and_a_right_circle_in_turn_each_until_the_heading_has_come_round() -> None:
    driver = DRIVERS["figure8"](context())
    angular = 2.0 * 0.4 / 1.5
    step = math.tau / 100 + 1e-9
    yaw, signs = 2.0, []
    for _ in range(303):
        twist = driver.command(at(math.remainder(yaw, math.tau)))
        assert (twist.linear, abs(twist.angular)) == pytest.approx((0.4, angular))
        side = math.copysign(1.0, twist.angular)
        signs.append(side)
        yaw += step * side
    assert signs == [1.0] * 100 + [-1.0] * 100 + [1.0] * 100 + [-1.0] * 3


def test_a_command_ends_after_the_timeout_and_the_next_one_has_its_own() -> None:
    driver = CmdVel(replace(context(), command_timeout_ns=100_000_000))
    period_ns, said = 50_000_000, []
    for period in range(9):
        if period in (1, 5):
            driver.obey(Twist(0.1 * period))
        said.append(driver.command(Observation(period * period_ns, 0.0, 0.0, 0.0, None)).linear)
    assert said == pytest.approx([0.0, 0.1, 0.1, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0])
