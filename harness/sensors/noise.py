"""What corrupts a reading between the sensor and its topic: white noise, off unless asked for.

RoboTerrain's sensors have none. The values are those of the real rovers' configuration
(models/README.md, sensors): each sensor draws from its own generator.
"""

from dataclasses import dataclass, replace

import numpy as np

from harness.samples import Imu, LaserScan, Sample, Vector3


@dataclass(frozen=True, kw_only=True)
class NoiseLevels:
    """Standard deviations of white noise.

    Attributes:
        range_m: Of a lidar range [m] (estimate for an RPLidar S2).
        acceleration: Of specific force [m/s^2]: root of the 1e-3 covariance of leo_bringup.
        angular_velocity: Of angular rate [rad/s]: root of its 1e-6 covariance.
    """

    range_m: float = 0.01
    acceleration: float = 0.032
    angular_velocity: float = 0.001


class WhiteNoise:
    """Adds noise to scans and IMU readings; leaves everything else as it is."""

    def __init__(
        self,
        levels: NoiseLevels,
        range_limits: tuple[float, float],
        scan_rng: np.random.Generator,
        imu_rng: np.random.Generator,
    ) -> None:
        self._levels = levels
        self._range_min, self._range_max = range_limits
        self._scan_rng, self._imu_rng = scan_rng, imu_rng

    def corrupt(self, sample: Sample) -> Sample:
        """The reading as a noisy sensor would give it."""
        if isinstance(sample, LaserScan):
            return self._corrupt_scan(sample)
        if isinstance(sample, Imu):
            return self._corrupt_imu(sample)
        return sample

    def _corrupt_scan(self, scan: LaserScan) -> LaserScan:
        noise = self._scan_rng.normal(0.0, self._levels.range_m, scan.ranges.shape)
        ranges = (scan.ranges + noise).astype(np.float32)  # inf stays inf
        ranges[ranges < self._range_min] = -np.inf  # REP-117: nearer than the sensor can see
        ranges[ranges > self._range_max] = np.inf
        return replace(scan, ranges=ranges)

    def _corrupt_imu(self, imu: Imu) -> Imu:
        force, rate = self._levels.acceleration, self._levels.angular_velocity
        return replace(
            imu,
            linear_acceleration=self._shaken(imu.linear_acceleration, force),
            angular_velocity=self._shaken(imu.angular_velocity, rate),
        )

    def _shaken(self, value: Vector3, sigma: float) -> Vector3:
        x, y, z = (np.array(value) + self._imu_rng.normal(0.0, sigma, 3)).tolist()
        return x, y, z
