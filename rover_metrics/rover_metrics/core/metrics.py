"""Traversal metrics: sensor samples in, a row out. No ROS, no clock, no file.

Semantics are those of RoboTerrain's metrics node, literally: the minimum of the finite ranges,
strict comparisons, one collision per scan, gravity included, windows of the last 100 samples. The
windows are those of its specification, not of its code: since January 2025 that never trims the IMU's
buffer, so in its logs Current Smoothness is the mean since the start.
All sums and means are float64; ranges pass through float32 as in sensor_msgs/LaserScan, so samples
that come straight from a simulator and samples that came over ROS give the same rows, to the byte.
"""

import math
from collections import deque
from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from rover_metrics.core.columns import Row
from rover_metrics.core.rotation import Vector3
from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, Thresholds

WINDOW = 100  # samples

# Beyond these a sample is a fault, not a reading: one of 1e300 would swallow all others of a sum.
# RoboTerrain's logs reach 427 m/s^2; gyroscopes of 4000 deg/s, the widest range on sale, 70 rad/s.
LARGEST_ACCELERATION = 1e5  # m/s^2: ten thousand g
LARGEST_ANGULAR_RATE = 1e4  # rad/s
LARGEST_SPEED = 1e4  # m/s: more than an orbit takes


class TraversalMetrics:
    """Counts, sums and windows over the samples of one session.

    Each add method takes one sample and returns whether it was usable. A sample with a component that
    is not finite or beyond all physics is left out, for it would spoil a cumulative sum for ever.

    Attributes:
        thresholds: Replaceable at any time; new ones hold for the samples and rows that follow.
        total_collisions: Scans so far whose nearest range was below the collision threshold.
        clearance: Nearest finite range of the latest usable scan [m]; inf before the first.
        farthest: Farthest finite range of that scan [m]; -inf before the first.
        smoothness_metric: Sum of |a| + |w| over all IMU samples [m/s^2 + rad/s].
        total_distance: Path length so far, outliers left out [m].
        last_step: Distance between the latest two poses, counted or not [m].
    """

    def __init__(self, thresholds: Thresholds = DEFAULT_THRESHOLDS) -> None:
        self.thresholds = thresholds
        self.total_collisions = 0
        self.clearance = math.inf
        self.farthest = -math.inf
        self.smoothness_metric = 0.0
        self.total_distance = 0.0
        self.last_step = 0.0
        self._clearances: deque[float] = deque(maxlen=WINDOW)
        self._smoothness: deque[float] = deque(maxlen=WINDOW)
        self._velocities: deque[float] = deque(maxlen=WINDOW)
        self._latest_imu: tuple[float, bool, float] = (0, False, 0)  # |a|, whether it is rough, |az|
        self._position: Vector3 | None = None

    def add_scan(self, ranges: ArrayLike) -> bool:
        """Takes the ranges of one lidar scan [m], coded as REP-117 says; float32 is read in place.

        Without a finite one nothing changes: clearance stays as it was.
        """
        values = np.asarray(ranges, dtype=np.float32)
        finite = values[np.isfinite(values)]
        if finite.size == 0:
            return False
        # argmin takes a sixth of the time of min here, and this runs between simulation and clock.
        self.clearance = float(finite[finite.argmin()])
        self.farthest = float(finite[finite.argmax()])
        self._clearances.append(self.clearance)
        if self.clearance < self.thresholds.collision_threshold:
            self.total_collisions += 1
        return True

    def add_imu(self, acceleration: Vector3, angular_velocity: Vector3) -> bool:
        """Takes an acceleration, gravity included [m/s^2], and a rate [rad/s], both in the IMU frame."""
        accel = math.hypot(*acceleration)
        angular = math.hypot(*angular_velocity)
        if not (accel <= LARGEST_ACCELERATION and angular <= LARGEST_ANGULAR_RATE):
            return False  # NaN too, which compares false
        is_rough_terrain = accel > self.thresholds.rough_terrain_threshold
        self._latest_imu = (accel, is_rough_terrain, abs(acceleration[2]))
        self._smoothness.append(accel + angular)
        self.smoothness_metric += accel + angular
        return True

    def add_pose(self, position: Vector3) -> bool:
        """Takes a true position in the world frame [m].

        A step of distance_threshold or more is not travel but a jump; the next step starts from
        where the jump ended.
        """
        if not math.isfinite(math.hypot(*position)):
            return False
        if self._position is not None:
            self.last_step = math.dist(self._position, position)
            if self.last_step < self.thresholds.distance_threshold:
                self.total_distance += self.last_step
        self._position = position
        return True

    def add_odometry(self, linear_velocity: Vector3) -> bool:
        """Takes the linear velocity that wheel odometry tells, in the body frame [m/s]."""
        speed = math.hypot(*linear_velocity)
        if not speed <= LARGEST_SPEED:
            return False
        self._velocities.append(speed)
        return True

    def row(self, stamp_s: int) -> Row:
        """Returns the row of the session so far, at a ROS time [s].

        A window without samples gives the integer 0, as RoboTerrain's node writes it ("0", where a
        mean of zero is "0.0"); a clearance without samples is inf.
        """
        clearance = _mean(self._clearances, empty=math.inf)
        magnitude, is_rough_terrain, vertical_roughness = self._latest_imu
        return Row(
            stamp_s=stamp_s,
            total_collisions=self.total_collisions,
            collision_status=int(clearance < self.thresholds.collision_threshold),
            smoothness_metric=self.smoothness_metric,
            current_smoothness=_mean(self._smoothness, empty=0),
            obstacle_clearance=clearance,
            distance_traveled=self.total_distance,
            current_velocity=_mean(self._velocities, empty=0),
            imu_acceleration_magnitude=magnitude,
            is_rough_terrain=int(is_rough_terrain),
            vertical_roughness=vertical_roughness,
        )


def _mean(values: Iterable[float], *, empty: float) -> float:
    window = np.fromiter(values, dtype=np.float64)
    return float(window.mean()) if window.size else empty
