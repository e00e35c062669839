"""What agents observe, as arrays made of sensor samples, and the spaces of these arrays.

Pure: an environment, a driver and a ROS node that have the same samples make the same arrays.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeVar, cast

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from harness.samples import Imu, LaserScan, Odometry, Pose, Quaternion, Sample
from harness.world.heightfield import Heightfield

Observation = dict[str, NDArray[np.float32]]
Point = tuple[float, float]

FARTHEST_GOAL = 100.0  # [m]
LARGEST_FORCE, LARGEST_RATE, LARGEST_SPEED = 100.0, 50.0, 10.0  # [m/s^2], [rad/s], [m/s] and [rad/s]

AHEAD = tuple(round(-0.5 + 0.2 * n, 3) for n in range(11))  # [m] at which the ground is scanned
LEFT = tuple(round(0.6 - 0.2 * n, 3) for n in range(7))  # [m] likewise, from left to right
LARGEST_HEIGHT = 2.0  # [m] above or below the rover that is told

S = TypeVar("S")


@dataclass(frozen=True)
class Part:
    """One entry of a Dict observation.

    Attributes:
        low: Smallest value, of all or of each; likewise `high`.
        about: What it is, with units, for the docs.
    """

    low: tuple[float, ...]
    high: tuple[float, ...]
    about: str
    size: int = 0  # if all have the same limits

    def space(self) -> spaces.Box:
        """Returns its space."""
        if self.size:
            return spaces.Box(self.low[0], self.high[0], (self.size,), np.float32)
        return spaces.Box(np.array(self.low, np.float32), np.array(self.high, np.float32))


def space_of(parts: Mapping[str, Part]) -> spaces.Dict:
    """Returns the space of an observation of these parts."""
    return spaces.Dict({name: part.space() for name, part in parts.items()})


def clipped(values: Mapping[str, object], space: spaces.Dict) -> Observation:
    """Returns an observation within its space: float32, in new arrays."""
    boxes = cast("Mapping[str, spaces.Box]", space.spaces)
    return {
        name: np.minimum(np.maximum(np.asarray(values[name], np.float32), box.low), box.high)
        for name, box in boxes.items()
    }


def latest(readings: Mapping[type[Sample], Sample], kind: type[S]) -> S:
    """Returns the last sample of a kind."""
    return cast("S", readings[cast("type[Sample]", kind)])


def attitude(quaternion: Quaternion) -> tuple[float, float, float]:
    """Returns roll, pitch and yaw [rad] of a frame in the world (REP-103: z, then y, then x)."""
    x, y, z, w = quaternion
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2.0 * (w * y - z * x))))
    return roll, pitch, math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def way_to(goal: Point, pose: Pose) -> tuple[float, float]:
    """Returns distance [m] and bearing [rad] of a goal as seen from a pose, left positive."""
    x, y, _ = pose.position
    east, north = goal[0] - x, goal[1] - y
    bearing = math.atan2(north, east) - attitude(pose.orientation)[2]
    return math.hypot(east, north), math.remainder(bearing, math.tau)


def visible(scan: LaserScan, farthest: float) -> NDArray[np.float32]:
    """Returns ranges as numbers [m]: a miss and a fault are the largest, what is too near is 0.

    Args:
        scan: REP-117 coded.
        farthest: What a miss becomes [m].
    """
    return np.fmax(np.fmin(scan.ranges, np.float32(farthest)), np.float32(0.0))  # fmin drops NaN


def heights_around(ground: Heightfield, pose: Pose) -> list[float]:
    """Returns the ground's heights over the rover's model frame [m] at AHEAD x LEFT of it, row by row.

    Obstacles are not in it; the grid turns with the heading, not with roll and pitch.
    """
    x, y, z = pose.position
    yaw = attitude(pose.orientation)[2]
    cos, sin = math.cos(yaw), math.sin(yaw)
    return [
        ground.height_at(x + cos * ahead - sin * left, y + sin * ahead + cos * left) - z
        for ahead in AHEAD
        for left in LEFT
    ]


def height_part() -> Part:
    """Returns what `heights_around` tells, as a part of an observation."""
    where = f"{AHEAD[0]:g} to {AHEAD[-1]:g} m ahead, {LEFT[0]:g} m left to right, every 0.2 m"
    about = f"heights of the ground without obstacles over the rover [m], {where}"
    return Part((-LARGEST_HEIGHT,), (LARGEST_HEIGHT,), about, len(AHEAD) * len(LEFT))


def point_nav_parts(beams: int, range_max: float) -> dict[str, Part]:
    """Returns what RoverHarness/PointNav observes.

    Args:
        beams: Of the lidar.
        range_max: Of the lidar [m].
    """
    imu = (LARGEST_FORCE,) * 3 + (LARGEST_RATE,) * 3 + (math.pi, math.pi / 2)
    lidar = "ranges of /scan [m], the first ahead, then counter-clockwise; a miss is the largest"
    return {
        "lidar": Part((0.0,), (range_max,), lidar, beams),
        "goal": Part(
            (0.0, -1.0, -1.0), (FARTHEST_GOAL, 1.0, 1.0), "distance [m], sine, cosine of bearing"
        ),
        "imu": Part(
            tuple(-limit for limit in imu),
            imu,
            "specific force [m/s^2], angular rate [rad/s] along x, y, z, roll, pitch [rad] of /imu/data",
        ),
        "velocities": Part(
            (-LARGEST_SPEED,) * 2,
            (LARGEST_SPEED,) * 2,
            "speed [m/s], yaw rate [rad/s] of /odometry/wheels",
        ),
    }


def point_nav_values(
    readings: Mapping[type[Sample], Sample], goal: Point, range_max: float
) -> dict[str, object]:
    """Returns what RoverHarness/PointNav observes, before it is clipped to its space.

    Args:
        readings: The last LaserScan, Imu, Pose and Odometry.
        goal: In the world [m].
        range_max: Of the lidar [m].
    """
    imu, twist = latest(readings, Imu), latest(readings, Odometry).twist
    distance, bearing = way_to(goal, latest(readings, Pose))
    roll, pitch, _ = attitude(imu.orientation)
    return {
        "lidar": visible(latest(readings, LaserScan), range_max),
        "goal": (distance, math.sin(bearing), math.cos(bearing)),
        "imu": (*imu.linear_acceleration, *imu.angular_velocity, roll, pitch),
        "velocities": (twist.linear, twist.angular),
    }
