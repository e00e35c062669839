"""The noise presets against the chips' numbers; who draws from which generator."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.samples import Imu, LaserScan, Odometry, Twist, Vector3
from harness.sensors.corruption import AxisErrors
from harness.sensors.noise import GAZEBO, HARDWARE, NoisePreset, SensorNoise

ORIGIN: Vector3 = (0.0, 0.0, 0.0)


def noise(preset: NoisePreset) -> SensorNoise:
    return SensorNoise(preset, (0.5, 2.0), np.random.default_rng(1), np.random.default_rng(2))


def imu(stamp_ns: int = 0, force: Vector3 = ORIGIN, rate: Vector3 = ORIGIN) -> Imu:
    return Imu(stamp_ns, (0.5, -0.5, 0.5, 0.5), rate, force)


def test_hardware_tilts_the_attitude_by_the_bias_of_the_accelerometer_over_gravity() -> None:
    """About the sensor's own axes, the same for all readings of a run; other draws do not change."""
    exact = imu(force=(0.0, 0.0, 9.8))
    level = Rotation.from_quat(exact.orientation)
    turns = []
    for seed in range(400):
        noisy = SensorNoise(HARDWARE, (0.5, 2.0), np.random.default_rng(1), np.random.default_rng(seed))
        one, other = noisy.corrupt(exact), noisy.corrupt(replace(exact, stamp_ns=10**9))
        assert isinstance(one, Imu)
        assert isinstance(other, Imu)
        assert one.orientation == other.orientation
        turns.append((level.inv() * Rotation.from_quat(one.orientation)).as_rotvec())
    assert np.std(turns, axis=0) == pytest.approx([0.020] * 3, rel=0.15)
    assert np.mean(turns, axis=0) == pytest.approx([0.0] * 3, abs=0.004)
    assert HARDWARE.attitude.variance == pytest.approx(0.020**2)  # what the messages tell


def test_chatter_shakes_the_forces_of_a_rover_that_moves_before_the_sensors_own_errors() -> None:
    noisy, still = noise(GAZEBO), imu(force=(0.1, 0.2, 9.8), rate=(0.3, 0.2, 0.1))
    stepped = noise(replace(GAZEBO, acceleration=AxisErrors(step=0.5, limit=9.0)))
    assert noisy.corrupt(still) == still
    for one in (noisy, stepped):
        one.corrupt(Odometry(0, 3.0, 4.0, 1.0, Twist(2.0, 0.7)))
    shaken = noisy.corrupt(still)
    assert isinstance(shaken, Imu)
    assert shaken.linear_acceleration != pytest.approx(still.linear_acceleration)
    assert shaken.angular_velocity == pytest.approx(still.angular_velocity)
    samples = [stepped.corrupt(still) for _ in range(200)]
    forces = np.array([sample.linear_acceleration for sample in samples if isinstance(sample, Imu)])
    assert set(np.abs(forces).ravel() % 0.5) == {0.0}
    assert np.abs(forces).max() == 9.0
    noisy.corrupt(Odometry(0, 3.0, 4.0, 1.0, Twist(0.0, 0.7)))
    assert noisy.corrupt(still) == still


def test_ranges_beyond_the_lidars_limits_become_misses_and_near_returns() -> None:
    noisy = noise(GAZEBO)
    reading = noisy.corrupt(LaserScan(7, np.array([0.4, 0.6, 1.9, 2.1], dtype=np.float32)))
    assert isinstance(reading, LaserScan)
    assert reading.ranges.dtype == np.float32
    assert reading.ranges.tolist() == pytest.approx([-np.inf, 0.6, 1.9, np.inf])
