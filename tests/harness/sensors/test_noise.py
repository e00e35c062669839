"""The noise presets against the chips' numbers, from samples; who draws from which generator."""

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.config import EpisodeConfig
from harness.episode.episode import Episode
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist, Vector3
from harness.sensors.noise import (
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
    (WHITE, "linear_acceleration", (1e-3**0.5, 0.0, 0.0, 0.0, np.inf)),
    (WHITE, "angular_velocity", (1e-6**0.5, 0.0, 0.0, 0.0, np.inf)),
    (HARDWARE, "linear_acceleration", (0.008 * G, 0.060 / 3 * G, 5e-4 * G, G / 8192, 4 * G)),
    (
        HARDWARE,
        "angular_velocity",
        (0.1 * DEGREE, 5 / 3 * DEGREE, 0.003 * DEGREE, DEGREE / 65.5, 500 * DEGREE),
    ),
    (GAZEBO, "linear_acceleration", (0.0, 0.0, 0.0, 0.0, np.inf)),
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


def deviation(readings: NDArray[np.float64], expected: float) -> None:
    """The root mean square of n normal values, which lies within 5 deviations of 1 / sqrt(2 n)."""
    interval = 5.0 / np.sqrt(2.0 * readings.size)
    assert np.sqrt(np.mean(np.square(readings))) == pytest.approx(expected, rel=interval, abs=1e-9)


@pytest.mark.parametrize(
    ("preset", "quantity", "sheet"), INERTIAL, ids=[f"{p.name} {q}" for p, q, _ in INERTIAL]
)
def test_imu_errors_are_those_of_the_data_sheet(
    preset: NoisePreset, quantity: str, sheet: tuple[float, ...]
) -> None:
    white, bias, walk, step, limit = sheet
    rng = np.random.default_rng(5)
    fleet = [SensorNoise(preset, LIMITS, rng, rng) for _ in range(700)]
    switched_on = np.array([read(noisy, quantity, imu())[0] for noisy in fleet])
    deviation(switched_on, np.hypot(white, bias))  # what one reading differs by from sensor to sensor
    assert np.ptp(switched_on.mean(axis=0)) <= 8 * np.hypot(white, bias) / np.sqrt(len(fleet))

    one = read(fleet[0], quantity, *[imu()] * 700)
    deviation(np.diff(one, axis=0)[::2], white * np.sqrt(2.0))

    hour = 3600
    later = np.array([read(noisy, quantity, imu(hour * SECOND_NS))[0] for noisy in fleet])
    deviation(later - switched_on, np.hypot(white * np.sqrt(2.0), walk * np.sqrt(hour)))

    if step:
        counts = np.concatenate([one, switched_on]) / step
        np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)
        assert np.diff(np.unique(np.round(counts))).min() == 1.0
    largest = 3 * limit if np.isfinite(limit) else 1e4
    hit = (largest, -largest, 0.0)
    (ends,) = read(fleet[0], quantity, imu(hour * SECOND_NS, force=hit, rate=hit))[:, :2]
    clipped = min(limit, largest)
    assert ends == pytest.approx((clipped, -clipped), abs=0.2 if np.isinf(limit) else 1e-9)


@pytest.mark.parametrize(
    ("preset", "white", "step", "lost"),
    [(WHITE, 0.010, 0.0, 0.0), (HARDWARE, 0.030 / 3, 0.013, 0.01), (GAZEBO, 0.0, 0.0, 0.0)],
)
def test_range_errors_are_those_of_the_data_sheet(
    preset: NoisePreset, white: float, step: float, lost: float
) -> None:
    count, exact = 40_000, 5.005  # a whole number of steps
    ranges = read_scan(noise(preset), *[exact] * count)
    misses = np.isposinf(ranges)
    assert misses.sum() == pytest.approx(lost * count, abs=5 * np.sqrt(lost * count))
    errors = (ranges[~misses] - np.float32(exact)).astype(np.float64)
    deviation(errors, np.hypot(white, step / np.sqrt(12.0)))
    assert errors.mean() == pytest.approx(0.0, abs=5 * white / np.sqrt(count) + 1e-6)
    if step:
        np.testing.assert_allclose(errors / step, np.round(errors / step), atol=1e-3)


def test_the_chatter_of_gazebo_has_the_moments_of_its_definition() -> None:
    """Loads of variance 1 / 1.5 in 1 - exp(-v / 0.35), friction to 1 in 1 - exp(-v / 0.1)."""
    speed, force = 0.2, (2.0, -1.0, 9.0)
    weight = float(np.linalg.norm(force))
    noisy, count = noise(GAZEBO), 12_000
    noisy.corrupt(odometry(-speed))  # backwards is as bad
    x, y, z = read(noisy, "linear_acceleration", *[imu(force=force)] * count).T
    load = z / force[2]
    disturbed = load != 1.0
    assert disturbed.mean() == pytest.approx(1 - np.exp(-speed / 0.35), abs=0.02)
    assert load[disturbed].mean() == pytest.approx(1.0, abs=0.05)
    assert load[disturbed].var() == pytest.approx(1 / 1.5, rel=0.1)
    assert load.min() >= 0.0  # the ground pushes, it never pulls
    frictions = np.array([x / load - force[0], y / load - force[1]]) / weight
    slides = (np.abs(frictions) > 1e-9).all(axis=0)
    assert slides.mean() == pytest.approx(1 - np.exp(-speed / 0.1), abs=0.02)
    for friction in frictions[:, slides]:
        assert np.abs(friction).max() == pytest.approx(1.0, abs=0.01)
        assert friction.mean() == pytest.approx(0.0, abs=0.03)
        deviation(friction, 1 / np.sqrt(3))
    assert abs(np.corrcoef(*frictions[:, slides])[0, 1]) < 0.05
    assert abs(np.corrcoef(slides, disturbed)[0, 1]) < 0.05


def test_chatter_leaves_alone_a_rover_that_stands_and_every_rate() -> None:
    noisy = noise(GAZEBO)
    still = imu(force=(0.1, 0.2, 9.8), rate=(0.3, 0.2, 0.1))
    assert noisy.corrupt(still) == still
    noisy.corrupt(odometry(0.8))
    assert read(noisy, "linear_acceleration", still)[0] != pytest.approx(still.linear_acceleration)
    assert read(noisy, "angular_velocity", still)[0] == pytest.approx(still.angular_velocity)
    noisy.corrupt(odometry(0.0))
    assert noisy.corrupt(still) == still


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
    assert all(one != other for one, other in pairwise(preset.summary for preset in PRESETS.values()))
