"""The noise presets against the chips' numbers; who draws from which generator."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist, Vector3
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

# Deviation of a reading, of the bias at switch-on, of what it gains in a second; resolution; limit.
# leo_bringup: covariances 1e-3 and 1e-6. PS-MPU-9250A-01 rev. 1.0, tables 1 and 2: 8 mg and 0.1 deg/s
# RMS, bias 60 mg and 5 deg/s at three deviations, 8192 LSB/g at 4 g, 65.5 LSB/(deg/s) at 500.
INERTIAL = [
    (WHITE, "acceleration", (1e-3**0.5, 0.0, 0.0, 0.0, np.inf)),
    (WHITE, "angular_velocity", (1e-6**0.5, 0.0, 0.0, 0.0, np.inf)),
    (HARDWARE, "acceleration", (0.008 * G, 0.060 / 3 * G, 5e-4 * G, G / 8192, 4 * G)),
    (
        HARDWARE,
        "angular_velocity",
        (0.1 * DEGREE, 5 / 3 * DEGREE, 0.003 * DEGREE, DEGREE / 65.5, 500 * DEGREE),
    ),
    (GAZEBO, "acceleration", (0.0, 0.0, 0.0, 0.0, np.inf)),
    (GAZEBO, "angular_velocity", (0.0, 0.0, 0.0, 0.0, np.inf)),
]


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


@pytest.mark.parametrize(
    ("preset", "quantity", "sheet"), INERTIAL, ids=[f"{p.name} {q}" for p, q, _ in INERTIAL]
)
def test_imu_errors_are_those_of_the_data_sheet(
    preset: NoisePreset, quantity: str, sheet: tuple[float, ...]
) -> None:
    errors = getattr(preset, quantity)
    told = (errors.white, errors.bias, errors.walk, errors.step, errors.limit)
    assert told == pytest.approx(sheet, rel=0.02 if preset is WHITE else 1e-6)  # rounded there
    assert errors.correlation_time == np.inf


def test_what_an_imu_reads_is_its_force_and_its_rate_with_the_errors_of_each() -> None:
    rng, exact = np.random.default_rng(2), imu(force=(1.0, -2.0, 100.0), rate=(0.1, -0.2, 20.0))
    biases = [rng.normal(0.0, deviation, 3) for deviation in (0.020 * G, 5 / 3 * DEGREE)]
    force = exact.linear_acceleration + biases[0] + rng.normal(0.0, 0.008 * G, 3)
    rate = exact.angular_velocity + biases[1] + rng.normal(0.0, 0.1 * DEGREE, 3)
    reading = noise(HARDWARE).corrupt(exact)
    assert isinstance(reading, Imu)
    assert reading.linear_acceleration == pytest.approx((*force[:2], 4 * G), abs=0.51 * G / 8192)
    assert reading.angular_velocity == pytest.approx((*rate[:2], 500 * DEGREE), abs=0.51 * DEGREE / 65.5)


@pytest.mark.parametrize(
    ("preset", "errors"),
    [
        (WHITE, RangeErrors(white=0.010)),
        (HARDWARE, RangeErrors(white=0.030 / 3, step=0.013, dropout=0.01)),
        (GAZEBO, RangeErrors()),
    ],
)
def test_range_errors_are_those_of_the_data_sheet(preset: NoisePreset, errors: RangeErrors) -> None:
    assert preset.ranges == errors
    exact = np.full(5_000, 5.005, np.float32)
    expected = errors.corrupt(exact, LIMITS, np.random.default_rng(1))
    np.testing.assert_array_equal(read_scan(noise(preset), *exact.tolist()), expected)


def test_only_gazebos_contacts_chatter_as_was_fitted_to_its_logs() -> None:
    fitted = ContactChatter(speed=0.35, shape=1.5, sliding_speed=0.1, friction=1.0)
    assert [preset.chatter for preset in PRESETS.values()] == [None, None, fitted]


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


def test_an_episode_gives_its_second_generator_to_the_scan_and_its_third_to_the_imu() -> None:
    def first(kind: type[Sample], noise: str | None) -> Sample:
        config = EpisodeConfig(terrain="rocky", driver="straight", duration=0.05, seed=6, noise=noise)
        ticks = [tick for batch in Episode(config).batches() for tick in batch.ticks]
        return next(s for tick in ticks for s in tick.samples if isinstance(s, kind))

    _, scan_seed, imu_seed = np.random.SeedSequence(6, spawn_key=(10,)).spawn(3)
    clean, noisy = (first(LaserScan, noise) for noise in (None, "white"))
    assert isinstance(clean, LaserScan)
    assert isinstance(noisy, LaserScan)
    drawn = np.random.default_rng(scan_seed).normal(0.0, 0.01, clean.ranges.shape)
    seen = np.isfinite(clean.ranges) & np.isfinite(noisy.ranges)
    assert seen.sum() > 10
    assert noisy.ranges[seen] - clean.ranges[seen] == pytest.approx(drawn[seen], abs=1e-5)
    exact, read = (first(Imu, noise) for noise in (None, "white"))
    assert isinstance(exact, Imu)
    assert isinstance(read, Imu)
    force = np.subtract(read.linear_acceleration, exact.linear_acceleration)
    assert force == pytest.approx(np.random.default_rng(imu_seed).normal(0.0, 0.032, 3))


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


def test_there_are_three_presets_by_name() -> None:
    assert list(PRESETS) == ["white", "hardware", "gazebo"]
    assert list(PRESETS.values()) == [WHITE, HARDWARE, GAZEBO]
    assert DEFAULT_PRESET == "white"
    assert all(one != other for one, other in pairwise(preset.summary for preset in PRESETS.values()))
