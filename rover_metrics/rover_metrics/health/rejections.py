"""Names for what can be wrong with a sample, so that what is left out is counted by its reason."""

import math

import numpy as np
from numpy.typing import ArrayLike

from rover_metrics.core.metrics import LARGEST_ACCELERATION
from rover_metrics.core.rotation import Vector3

NOT_FINITE = "not finite"
NOT_FINITE_OR_OTHER = "not finite, or not the truth that harness.run publishes"
NO_POSE = "no pose"
NO_TIME = "no time: negative seconds, or nanoseconds of a second or more"
HUGE_ACCELERATION = "acceleration beyond all physics"
HUGE_ANGULAR_RATE = "angular velocity beyond all physics"
HUGE_SPEED = "speed beyond all physics"

JUMPED = "step of distance_threshold or more, no travel"

NO_RANGES = "scan without ranges"
ALL_NAN = "scan with NaN and no reading"
ALL_TOO_NEAR = "scan with -inf and no reading"
ZERO_OR_LESS = "range of zero or less, taken as a reading"
BELOW_LIMIT = "range below range_min, taken as a reading"
ABOVE_LIMIT = "range above range_max, taken as a reading"


def imu_fault(acceleration: Vector3, angular_velocity: Vector3) -> str:
    """Returns the name of what is wrong with an IMU sample that the metrics have refused."""
    if not all(map(math.isfinite, (*acceleration, *angular_velocity))):
        return NOT_FINITE
    is_huge = math.hypot(*acceleration) > LARGEST_ACCELERATION
    return HUGE_ACCELERATION if is_huge else HUGE_ANGULAR_RATE


def odometry_fault(linear_velocity: Vector3) -> str:
    """Returns the name of what is wrong with a velocity that the metrics have refused."""
    return HUGE_SPEED if all(map(math.isfinite, linear_velocity)) else NOT_FINITE


def unusable_scan(ranges: ArrayLike) -> str | None:
    """Returns what is odd about a scan without a finite range; None for open space, all inf."""
    values = np.asarray(ranges, dtype=np.float32)
    if values.size == 0:
        return NO_RANGES
    if np.isnan(values).any():
        return ALL_NAN
    return ALL_TOO_NEAR if np.isneginf(values).any() else None


def scan_oddity(nearest: float, farthest: float, range_min: float, range_max: float) -> str | None:
    """Returns what is odd about a scan that counts all the same; None if nothing is.

    Args:
        nearest: Smallest finite range [m].
        farthest: Largest finite range [m].
        range_min: Nearest range that the sensor says it can measure [m].
        range_max: Farthest one [m]; both are ignored if they are no interval.
    """
    if nearest <= 0.0:
        return ZERO_OR_LESS
    if range_min < range_max:
        if nearest < range_min:
            return BELOW_LIMIT
        if farthest > range_max:
            return ABOVE_LIMIT
    return None
