"""What drivers want of a rover that cannot turn in place."""

from collections.abc import Callable

import pytest

from harness.drivers.base import drivable
from harness.robots import RoverSpec
from harness.samples import Twist
from tests.support.rovers import LEO


@pytest.mark.parametrize(
    ("wanted", "driven"),
    [
        (Twist(0.0, 1.0), Twist(-0.6, 1.0)),  # backs up; cruises at 1 m/s
        (Twist(0.0, -0.1), Twist(-0.1 * 0.8622, -0.1)),  # tightest circle of 0.862 m
        (Twist(0.1, 1.0), Twist(0.4, 1.0)),
        (Twist(-0.1, 1.0), Twist(-0.4, 1.0)),
        (Twist(0.9, 1.0), Twist(0.9, 1.0)),
        (Twist(0.1, 0.0), Twist(0.1, 0.0)),
        (Twist(), Twist()),
    ],
)
def test_turning_in_place_becomes_backing_up_in_a_curve(
    wanted: Twist, driven: Twist, foreign: Callable[[str], RoverSpec]
) -> None:
    found = drivable(wanted, foreign("buggy"))
    assert (found.linear, found.angular) == pytest.approx((driven.linear, driven.angular), abs=1e-3)


def test_a_rover_that_turns_in_place_follows_any_twist() -> None:
    assert drivable(Twist(0.0, 1.0), LEO) == Twist(0.0, 1.0)
