"""What a driver that would turn in place commands to a rover that cannot: it backs up in a curve."""

import math

from harness.robots import RoverSpec
from harness.samples import Twist

BACKWARDS, SLOWEST = 0.6, 0.4  # of the cruising speed


def drivable(twist: Twist, rover: RoverSpec) -> Twist:
    """Returns a twist that the rover can follow, nearest to what a driver wants.

    Turning in place becomes backing up in the tightest curve, which turns the heading the same way and
    leaves what is ahead; a slow tight curve is driven fast enough to get round.

    Args:
        twist: As the driver commands it.
        rover: Which is to follow; one that turns in place follows any.
    """
    if not rover.steers or twist.angular == 0.0:
        return twist
    needed = abs(twist.angular) * rover.tightest_turn  # [m/s]
    if twist.linear == 0.0:
        return Twist(-min(needed, BACKWARDS * rover.cruise_speed), twist.angular)
    slowest = min(needed, SLOWEST * rover.cruise_speed)
    return Twist(math.copysign(max(abs(twist.linear), slowest), twist.linear), twist.angular)
