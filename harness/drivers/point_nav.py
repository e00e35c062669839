"""What point navigation observes and commands: arrays made of sensor samples, a twist made of an action.

Pure: an environment of harness.gym and the driver of a policy that have the same samples make the same.
"""

import math
from collections.abc import Mapping, Sequence
from typing import TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist
from rover_metrics.core import rotation

Point = tuple[float, float]
Limits = tuple[tuple[float, ...], tuple[float, ...]]  # of each number of an array, or one for all

SENSED: frozenset[type[Sample]] = frozenset((LaserScan, Imu, Pose, Odometry))
FARTHEST_GOAL = 100.0  # [m]
GOAL_RADIUS = 0.5  # [m] within which a goal counts as reached
LARGEST_FORCE, LARGEST_RATE, LARGEST_SPEED = 100.0, 50.0, 10.0  # [m/s^2], [rad/s], [m/s] and [rad/s]
IMU_LIMITS = (LARGEST_FORCE,) * 3 + (LARGEST_RATE,) * 3 + (math.pi, math.pi / 2)

S = TypeVar("S")


def limits(range_max: float) -> dict[str, Limits]:
    """Returns smallest and largest numbers of each array, by name, for a lidar of that range [m]."""
    return {
        "goal": ((0.0, -1.0, -1.0), (FARTHEST_GOAL, 1.0, 1.0)),
        "imu": (tuple(-limit for limit in IMU_LIMITS), IMU_LIMITS),
        "lidar": ((0.0,), (range_max,)),
        "velocities": ((-LARGEST_SPEED,) * 2, (LARGEST_SPEED,) * 2),
    }


def observed(
    readings: Mapping[type[Sample], Sample], goal: Point, range_max: float
) -> dict[str, object]:
    """Returns what is observed, by the names of `limits` and before it is kept within them.

    Args:
        readings: The last of each of SENSED.
        goal: In the world [m].
        range_max: Of the lidar [m].
    """
    imu, twist = latest(readings, Imu), latest(readings, Odometry).twist
    distance, bearing = way_to(goal, latest(readings, Pose))
    roll, pitch = rotation.roll_pitch(imu.orientation)
    return {
        "lidar": visible(latest(readings, LaserScan).ranges, range_max),
        "goal": (distance, math.sin(bearing), math.cos(bearing)),
        "imu": (*imu.linear_acceleration, *imu.angular_velocity, roll, pitch),
        "velocities": (twist.linear, twist.angular),
    }


def clipped(value: object, low: object, high: object) -> NDArray[np.float32]:
    """Returns numbers within their limits, as a new array of float32.

    Args:
        value: The numbers.
        low: Smallest of each, or of all.
        high: Largest of each, or of all.
    """
    least, most = np.asarray(low, np.float32), np.asarray(high, np.float32)
    return np.minimum(np.maximum(np.asarray(value, np.float32), least), most)


def commanded(action: Sequence[float], rover: RoverSpec) -> Twist:
    """Returns what an action commands: shares, -1 to 1, of the rover's top speed and yaw rate."""
    speed, rate = action
    return Twist(speed * rover.top_speed, rate * rover.cruise_yaw_rate)


def latest(readings: Mapping[type[Sample], Sample], kind: type[S]) -> S:
    """Returns the last sample of a kind."""
    return cast("S", readings[cast("type[Sample]", kind)])


def way_to(goal: Point, pose: Pose) -> tuple[float, float]:
    """Returns distance [m] and bearing [rad] of a goal as seen from a pose, left positive."""
    x, y, _ = pose.position
    east, north = goal[0] - x, goal[1] - y
    bearing = math.atan2(north, east) - rotation.yaw(pose.orientation)
    return math.hypot(east, north), math.remainder(bearing, math.tau)


def visible(ranges: NDArray[np.float32], farthest: float) -> NDArray[np.float32]:
    """Returns REP-117 ranges as numbers [m]: a miss and a fault are the farthest, too near is 0."""
    return np.fmax(np.fmin(ranges, np.float32(farthest)), np.float32(0.0))  # fmin drops NaN
