"""What corrupts a reading between the sensor and its topic: named presets, off unless asked for.

RoboTerrain's sensors have no noise. Scan and IMU draw from generators of their own, so that the one
does not change with the other's rate.
"""

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from harness.samples import Imu, LaserScan, Odometry, Quaternion, Sample, Vector3
from harness.sensors.corruption import AxisErrors, AxisTriad, ContactChatter, RangeErrors

if TYPE_CHECKING:  # it loads filters that most runs do without
    from harness.sensors.vibration import Vibration

G = 9.80665  # [m/s^2], the unit that data sheets count in, wherever the rover is
DEGREE = np.pi / 180.0  # [rad]


@dataclass(frozen=True, kw_only=True)
class NoisePreset:
    """The errors of all sensors."""

    name: str
    summary: str
    acceleration: AxisErrors = field(default_factory=AxisErrors)  # of specific force [m/s^2]
    angular_velocity: AxisErrors = field(default_factory=AxisErrors)  # of angular rate [rad/s]
    # of the orientation, as turns about the sensor's axes [rad]
    attitude: AxisErrors = field(default_factory=AxisErrors)
    # standard deviation of the share by which the wheels of a side are larger than the odometry
    # takes them for
    wheel_radius: float = 0.0
    # variances that wheel odometry states of speed [m^2/s^2] and yaw rate [rad^2/s^2]; 0, 0 for none
    twist_variance: tuple[float, float] = (0.0, 0.0)
    ranges: RangeErrors = field(default_factory=RangeErrors.model_construct)
    # what shakes the IMU before its own errors come on top; None for nothing
    chatter: ContactChatter | None = None


WHITE = NoisePreset(
    name="white",
    summary="white noise of Leo's configuration; lidar 10 mm",
    # Roots of the covariances 1e-3 and 1e-6 in leo_bringup's firmware_message_converter.yaml.
    acceleration=AxisErrors(white=0.032),
    angular_velocity=AxisErrors(white=0.001),
    ranges=RangeErrors.model_construct(white=0.01),  # estimate
)

HARDWARE = NoisePreset(
    name="hardware",
    summary="MPU-9250 at +-4 g and 500 deg/s with bias, walk, 16 bits; RPLIDAR S2 with lost returns; "
    "other tyres",
    # InvenSense PS-MPU-9250A-01 rev. 1.0, table 2: total RMS noise 8 mg, bias tolerance 60 mg (z: 80 mg)
    # taken as three deviations, 8192 LSB/g; table 1: 0.1 deg/s, 5 deg/s as
    # three deviations, 65.5 LSB/(deg/s).
    # Ranges as Leo's firmware sets them (imu.cpp). The walks are estimates.
    acceleration=AxisErrors(white=0.008 * G, bias=0.020 * G, walk=5e-4 * G, step=G / 8192, limit=4 * G),
    angular_velocity=AxisErrors(
        white=0.1 * DEGREE,
        bias=5 / 3 * DEGREE,
        walk=0.003 * DEGREE,
        step=DEGREE / 65.5,
        limit=500 * DEGREE,
    ),
    # What makes an attitude of these leans on gravity, so it is off by the accelerometer's bias over g;
    # the heading, of a compass, is taken to be as good: an estimate.
    attitude=AxisErrors(bias=0.020),
    # An estimate: the tyres of DRIVE's Husky were 3.8 % smaller than published, both sides alike.
    wheel_radius=0.005,
    twist_variance=(1e-4, 1e-3),  # leo_bringup's firmware_message_converter.yaml
    # Estimates for an RPLIDAR S2: +-30 mm (some say 50) taken as three deviations, 13 mm resolution,
    # 1 % lost.
    ranges=RangeErrors.model_construct(white=0.010, step=0.013, dropout=0.01),
)

GAZEBO = NoisePreset(
    name="gazebo",
    summary="the IMU of RoboTerrain's Gazebo: one step's contacts, which mesh tyres make chatter",
    # Fitted to acceleration and vertical roughness over velocity in the recorded logs of 2025-01-16
    # (python -m harness.validate --realism), friction to |az| / |a|, falling to rows below 0.3 m/s^2,
    # landing to the largest; exact apart from that.
    chatter=ContactChatter(
        speed=0.42, shape=1.6, falling=0.038, landing=10.0, sliding_speed=0.15, friction=1.0
    ),
)

EXACT = NoisePreset(name="none", summary="no errors, for what vibrates alone")
PRESETS = {preset.name: preset for preset in (WHITE, HARDWARE, GAZEBO)}


class SensorNoise:
    """Corrupts scans and IMU readings; leaves everything else as it is.

    Chatter and vibration follow the latest speed in the odometry, which passes here too.

    Args:
        preset: The errors.
        range_limits: Nearest and farthest range of the lidar [m].
        scan_rng: Of the scans' errors.
        imu_rng: Of the IMU's errors.
        vibration: Shakes the IMU before its errors; None for nothing.

    Attributes:
        wheel_scale: Radius of the wheels, left and right, over the one that the odometry knows.
    """

    def __init__(
        self,
        preset: NoisePreset,
        range_limits: tuple[float, float],
        scan_rng: np.random.Generator,
        imu_rng: np.random.Generator,
        vibration: "Vibration | None" = None,
    ) -> None:
        self._preset, self._range_limits = preset, range_limits
        self._scan_rng, self._imu_rng = scan_rng, imu_rng
        self._force = AxisTriad(preset.acceleration, imu_rng)
        self._rate = AxisTriad(preset.angular_velocity, imu_rng)
        (attitude_rng,) = imu_rng.spawn(1)  # draws nothing of the others'
        self._attitude = AxisTriad(preset.attitude, attitude_rng)
        left, right = (1.0 + preset.wheel_radius * attitude_rng.standard_normal(2)).tolist()
        self.wheel_scale = left, right
        self._vibration, self._wheel_speed = vibration, 0.0

    def corrupt(self, sample: Sample) -> Sample:
        """Returns the reading as a faulty sensor would give it."""
        if isinstance(sample, Odometry):
            self._wheel_speed = sample.twist.linear
        if isinstance(sample, LaserScan):
            ranges = self._preset.ranges.corrupt(sample.ranges, self._range_limits, self._scan_rng)
            return replace(sample, ranges=ranges)
        if isinstance(sample, Imu):
            force = sample.linear_acceleration
            if self._preset.chatter is not None:
                force = self._preset.chatter.shake(force, self._wheel_speed, self._imu_rng)
            if self._vibration is not None:
                force = self._vibration.shake(force, self._wheel_speed, sample.stamp_ns)
            force = self._force.corrupt(force, sample.stamp_ns)
            rate = self._rate.corrupt(sample.angular_velocity, sample.stamp_ns)
            turn = self._attitude.corrupt((0.0, 0.0, 0.0), sample.stamp_ns)
            turned = _turned(sample.orientation, turn) if any(turn) else sample.orientation
            return replace(sample, linear_acceleration=force, angular_velocity=rate, orientation=turned)
        return sample


def _turned(orientation: Quaternion, turn: Vector3) -> Quaternion:
    """An orientation (x, y, z, w), turned in its own axes by a rotation vector [rad]."""
    x, y, z, w = orientation
    a, b, c = (0.5 * angle for angle in turn)  # small ones
    d = math.sqrt(max(0.0, 1.0 - a * a - b * b - c * c))
    return (
        w * a + x * d + y * c - z * b,
        w * b + y * d + z * a - x * c,
        w * c + z * d + x * b - y * a,
        w * d - x * a - y * b - z * c,
    )
