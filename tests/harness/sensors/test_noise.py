"""The noise presets against the chips' numbers; who draws from which generator."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.samples import Imu, LaserScan, Odometry, Pose, Twist, Vector3
from harness.sensors.corruption import AxisErrors, ContactChatter, RangeErrors
from harness.sensors.noise import (
    DEFAULT_PRESET,
    GAZEBO,
    HARDWARE,
    PRESETS,
    WHITE,
    NoisePreset,
    SensorNoise,
)

LIMITS = (0.15, 10.0)
SECOND_NS = 1_000_000_000
G, DEGREE = 9.80665, np.radians(1.0)
ORIGIN: Vector3 = (0.0, 0.0, 0.0)
ALL = pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)


def about(value: float, share: float = 1e-6) -> Any:  # noqa: ANN401 - in the place of a number
    return pytest.approx(value, rel=share)


# leo_bringup: covariances 1e-3 and 1e-6, roots rounded there. PS-MPU-9250A-01 rev. 1.0, tables 1 and 2:
# 8 mg and 0.1 deg/s RMS, bias 60 mg and 5 deg/s at three deviations, 8192 LSB/g at 4 g, 65.5 LSB/(deg/s)
# at 500. RPLIDAR S2: 30 mm at three deviations, 13 mm steps.
SHEETS = (
    NoisePreset(
        name="white",
        summary=WHITE.summary,
        acceleration=AxisErrors(white=about(1e-3**0.5, 0.02)),
        angular_velocity=AxisErrors(white=about(1e-6**0.5, 0.02)),
        ranges=RangeErrors(white=0.010),
    ),
    NoisePreset(
        name="hardware",
        summary=HARDWARE.summary,
        acceleration=AxisErrors(
            white=about(0.008 * G),
            bias=about(0.060 / 3 * G),
            walk=about(5e-4 * G),
            step=about(G / 8192),
            limit=about(4 * G),
        ),
        angular_velocity=AxisErrors(
            white=about(0.1 * DEGREE),
            bias=about(5 / 3 * DEGREE),
            walk=about(0.003 * DEGREE),
            step=about(DEGREE / 65.5),
            limit=about(500 * DEGREE),
        ),
        ranges=RangeErrors(white=0.030 / 3, step=0.013, dropout=0.01),
    ),
    NoisePreset(  # as was fitted to its logs; nothing else
        name="gazebo",
        summary=GAZEBO.summary,
        chatter=ContactChatter(speed=0.35, shape=1.5, sliding_speed=0.1, friction=1.0),
    ),
)


def noise(preset: NoisePreset = WHITE, scan_seed: int = 1, imu_seed: int = 2) -> SensorNoise:
    scan_rng, imu_rng = np.random.default_rng(scan_seed), np.random.default_rng(imu_seed)
    return SensorNoise(preset, LIMITS, scan_rng, imu_rng)


def scan(*ranges: float) -> LaserScan:
    return LaserScan(7, np.array(ranges, dtype=np.float32))


def imu(stamp_ns: int = 0, force: Vector3 = ORIGIN, rate: Vector3 = ORIGIN) -> Imu:
    return Imu(stamp_ns, (0.5, -0.5, 0.5, 0.5), rate, force)


def odometry(speed: float) -> Odometry:
    return Odometry(0, 3.0, 4.0, 1.0, Twist(speed, 0.7))


def read_scan(noisy: SensorNoise, *ranges: float) -> NDArray[np.float32]:
    reading = noisy.corrupt(scan(*ranges))
    assert isinstance(reading, LaserScan)
    assert reading.ranges.dtype == np.float32
    return reading.ranges


def read(noisy: SensorNoise, quantity: str, *samples: Imu) -> NDArray[np.float64]:
    return np.array([getattr(noisy.corrupt(sample), quantity) for sample in samples])


def test_what_an_imu_reads_is_its_force_and_its_rate_with_the_errors_of_each() -> None:
    rng, exact = np.random.default_rng(2), imu(force=(1.0, -2.0, 100.0), rate=(0.1, -0.2, 20.0))
    biases = [rng.normal(0.0, deviation, 3) for deviation in (0.020 * G, 5 / 3 * DEGREE)]
    force = exact.linear_acceleration + biases[0] + rng.normal(0.0, 0.008 * G, 3)
    rate = exact.angular_velocity + biases[1] + rng.normal(0.0, 0.1 * DEGREE, 3)
    reading = noise(HARDWARE).corrupt(exact)
    assert isinstance(reading, Imu)
    assert reading.linear_acceleration == pytest.approx((*force[:2], 4 * G), abs=0.51 * G / 8192)
    assert reading.angular_velocity == pytest.approx((*rate[:2], 500 * DEGREE), abs=0.51 * DEGREE / 65.5)


@ALL
def test_a_scan_is_read_with_the_errors_of_its_ranges(preset: NoisePreset) -> None:
    exact = np.full(5_000, 5.005, np.float32)
    expected = preset.ranges.corrupt(exact, LIMITS, np.random.default_rng(1))
    np.testing.assert_array_equal(read_scan(noise(preset), *exact.tolist()), expected)


def test_chatter_leaves_alone_a_rover_that_stands_and_every_rate() -> None:
    noisy = noise(GAZEBO)
    still = imu(force=(0.1, 0.2, 9.8), rate=(0.3, 0.2, 0.1))
    assert noisy.corrupt(still) == still
    noisy.corrupt(odometry(0.8))
    assert read(noisy, "linear_acceleration", still)[0] != pytest.approx(still.linear_acceleration)
    assert read(noisy, "angular_velocity", still)[0] == pytest.approx(still.angular_velocity)
    noisy.corrupt(odometry(0.0))
    assert noisy.corrupt(still) == still


def test_what_chatter_does_comes_before_the_sensors_own_errors() -> None:
    shaken = replace(GAZEBO, acceleration=AxisErrors(step=0.5, limit=9.0))
    noisy, still = noise(shaken), imu(force=(0.1, 0.2, 9.8))
    noisy.corrupt(odometry(2.0))
    forces = read(noisy, "linear_acceleration", *[still] * 200)
    assert set(np.abs(forces).ravel() % 0.5) == {0.0}
    assert np.abs(forces).max() == 9.0


def test_scan_and_imu_draw_from_generators_of_their_own_force_before_rate() -> None:
    noisy = noise(WHITE, scan_seed=11, imu_seed=22)
    scan_draws, imu_draws = np.random.default_rng(11), np.random.default_rng(22)
    for _ in range(2):
        ranges = read_scan(noisy, 1.0, 2.0, 3.0)
        assert ranges == pytest.approx(np.array([1, 2, 3]) + scan_draws.normal(0.0, 0.01, 3), abs=1e-6)
        reading = noisy.corrupt(imu(force=(0.0, 0.0, 9.8), rate=(0.1, 0.2, 0.3)))
        assert isinstance(reading, Imu)
        assert reading.linear_acceleration == pytest.approx(
            np.array([0, 0, 9.8]) + imu_draws.normal(0.0, 0.032, 3)
        )
        assert reading.angular_velocity == pytest.approx(
            np.array([0.1, 0.2, 0.3]) + imu_draws.normal(0.0, 0.001, 3)
        )


@ALL
def test_no_preset_touches_the_generator_of_the_other_sensor(preset: NoisePreset) -> None:
    scan_rng, imu_rng = np.random.default_rng(1), np.random.default_rng(2)
    untouched = scan_rng.bit_generator.state
    noisy = SensorNoise(preset, LIMITS, scan_rng, imu_rng)
    noisy.corrupt(odometry(0.5))
    noisy.corrupt(imu(force=(0.0, 0.0, 9.8)))
    assert scan_rng.bit_generator.state == untouched
    untouched = imu_rng.bit_generator.state
    noisy.corrupt(scan(1.0, 2.0, 3.0))
    assert imu_rng.bit_generator.state == untouched


@ALL
def test_misses_near_returns_and_faults_stay_what_they_are(preset: NoisePreset) -> None:
    np.testing.assert_array_equal(
        read_scan(noise(preset), np.inf, -np.inf, np.nan), [np.inf, -np.inf, np.nan]
    )


@ALL
def test_a_reading_keeps_stamp_and_attitude_and_what_was_read_stays_as_it_was(
    preset: NoisePreset,
) -> None:
    noisy, exact = noise(preset), scan(1.0, 2.0, 3.0)
    noisy.corrupt(odometry(0.5))
    reading = noisy.corrupt(imu(SECOND_NS))
    assert isinstance(reading, Imu)
    assert (reading.stamp_ns, reading.orientation) == (SECOND_NS, imu().orientation)
    assert noisy.corrupt(exact).stamp_ns == 7
    assert exact.ranges.tolist() == [1.0, 2.0, 3.0]


@ALL
def test_poses_and_odometry_are_left_alone(preset: NoisePreset) -> None:
    noisy = noise(preset)
    for sample in (Pose(0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0)), odometry(0.5)):
        assert noisy.corrupt(sample) is sample


def test_ranges_beyond_the_lidars_limits_become_misses_and_near_returns() -> None:
    noisy = SensorNoise(GAZEBO, (0.5, 2.0), np.random.default_rng(0), np.random.default_rng(0))
    assert read_scan(noisy, 0.4, 0.6, 1.9, 2.1).tolist() == pytest.approx([-np.inf, 0.6, 1.9, np.inf])


def test_there_are_three_presets_by_name_with_the_errors_of_their_data_sheets() -> None:
    assert list(PRESETS) == ["white", "hardware", "gazebo"] == [preset.name for preset in SHEETS]
    assert tuple(PRESETS.values()) == SHEETS == (WHITE, HARDWARE, GAZEBO)
    assert DEFAULT_PRESET == "white"
    assert len({preset.summary for preset in SHEETS}) == 3
