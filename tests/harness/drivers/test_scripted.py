import math

import numpy as np

from harness.drivers import DRIVERS, DriverContext, Observation
from harness.samples import Twist
from tests.support.rovers import LEO


def context() -> DriverContext:
    return DriverContext(LEO, 20.0, np.zeros(1), np.random.default_rng(0))


def at(yaw: float) -> Observation:
    return Observation(0, 0.0, 0.0, yaw, None)


def test_straight_and_spin_command_one_axis_each() -> None:
    straight = DRIVERS["straight"](context()).command(at(0.0))
    spin = DRIVERS["spin"](context()).command(at(0.0))
    assert straight.linear > 0
    assert straight.angular == 0
    assert spin.linear == 0
    assert spin.angular > 0


def test_figure8_changes_side_after_each_full_turn() -> None:
    driver = DRIVERS["figure8"](context())
    yaw, sides = 0.0, []
    for _ in range(600):
        side = math.copysign(1.0, driver.command(at(math.remainder(yaw, math.tau))).angular)
        yaw += 0.05 * side
        sides.append(side)
    changes = [i for i in range(1, len(sides)) if sides[i] != sides[i - 1]]
    assert np.diff(changes).tolist() == [126] * (len(changes) - 1)
    assert abs(yaw) <= math.tau + 0.1


def test_cmd_vel_repeats_the_last_command() -> None:
    driver = DRIVERS["cmd_vel"](context())
    assert driver.command(at(0.0)) == Twist()
    driver.latest = Twist(0.2, 0.1)  # type: ignore[attr-defined]  # only the cmd_vel driver has it
    assert [driver.command(at(0.0)) for _ in range(2)] == [Twist(0.2, 0.1)] * 2
