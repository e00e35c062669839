from dataclasses import replace

import numpy as np
import pytest

from harness.errors import UsageError
from harness.samples import Imu, LaserScan, Odometry, Pose, Sample, Twist, Vector3
from harness.sensors.corruption import AxisErrors, AxisTriad, ContactChatter, RangeErrors
from harness.sensors.noise import (
    GAZEBO,
    HARDWARE,
    PRESETS,
    WHITE,
    NoisePreset,
    SensorNoise,
    chosen_preset,
    find_preset,
)

LIMITS = (0.15, 10.0)
PERIOD_NS = 50_000_000
G = 9.80665


def noise(preset: NoisePreset = WHITE, seed: int = 1) -> SensorNoise:
    scan_rng, imu_rng = (np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(2))
    return SensorNoise(preset, LIMITS, scan_rng, imu_rng)


def ranges_only(**errors: float) -> SensorNoise:
    return noise(NoisePreset(name="test", summary="", ranges=RangeErrors(**errors)))


def scan(*ranges: float) -> LaserScan:
    return LaserScan(0, np.array(ranges, dtype=np.float32))


def imu(stamp_ns: int = 0, force: Vector3 = (0.0, 0.0, 9.8)) -> Imu:
    return Imu(stamp_ns, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), force)


def odometry(speed: float) -> Odometry:
    return Odometry(0, 0.0, 0.0, 0.0, Twist(speed, 0.0))


def read_scan(noisy: SensorNoise, sample: LaserScan) -> LaserScan:
    reading = noisy.corrupt(sample)
    assert isinstance(reading, LaserScan)
    assert reading.ranges.dtype == np.float32
    return reading


def read_imu(noisy: SensorNoise, sample: Imu) -> Imu:
    reading = noisy.corrupt(sample)
    assert isinstance(reading, Imu)
    return reading


def test_the_default_has_the_deviations_of_leos_configuration() -> None:
    assert chosen_preset(choice=True) is WHITE
    noisy = noise()
    readings = [read_imu(noisy, imu()) for _ in range(5_000)]
    forces = np.array([reading.linear_acceleration for reading in readings])
    rates = np.array([reading.angular_velocity for reading in readings])
    ranges = read_scan(noisy, LaserScan(0, np.full(20_000, 5.0, dtype=np.float32))).ranges
    assert forces.std(axis=0) == pytest.approx(0.032, rel=0.05)
    assert rates.std(axis=0) == pytest.approx(0.001, rel=0.05)
    assert ranges.std() == pytest.approx(0.01, rel=0.03)
    assert ranges.mean() == pytest.approx(5.0, abs=1e-3)


def test_presets_are_found_by_name_and_off_means_none() -> None:
    assert [find_preset(name).name for name in PRESETS] == list(PRESETS)
    assert chosen_preset("gazebo") is GAZEBO
    assert chosen_preset(choice=False) is None


def test_an_unknown_preset_is_one_line_that_names_those_there_are() -> None:
    with pytest.raises(UsageError, match=r"'loud' does not exist; available: white, hardware, gazebo$"):
        find_preset("loud")


@pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)
def test_misses_near_returns_and_faults_stay_what_they_are(preset: NoisePreset) -> None:
    reading = read_scan(noise(preset), scan(np.inf, -np.inf, np.nan))
    assert np.isposinf(reading.ranges[0])
    assert np.isneginf(reading.ranges[1])
    assert np.isnan(reading.ranges[2])


def test_a_range_pushed_over_a_limit_is_coded_as_rep_117_says() -> None:
    both = LaserScan(0, np.tile(np.array([0.16, 9.99], dtype=np.float32), 500))
    ranges = read_scan(ranges_only(white=0.05), both).ranges
    near, far = ranges[::2], ranges[1::2]
    assert np.isneginf(near).any()
    assert near[np.isfinite(near)].min() >= np.float32(0.15)
    assert np.isposinf(far).any()
    assert far[np.isfinite(far)].max() <= 10.0


def test_a_lost_return_is_a_miss_and_never_a_zero() -> None:
    full = LaserScan(0, np.full(20_000, 5.0, dtype=np.float32))
    ranges = read_scan(ranges_only(dropout=0.1), full).ranges
    assert np.isposinf(ranges).mean() == pytest.approx(0.1, abs=0.01)
    assert set(ranges[np.isfinite(ranges)].tolist()) == {5.0}


def test_ranges_come_in_steps() -> None:
    ranges = read_scan(ranges_only(step=0.013), scan(1.0, 1.006, 1.02)).ranges
    assert ranges.tolist() == pytest.approx([1.001, 1.001, 1.014])


def triad(**errors: float) -> AxisTriad:
    return AxisTriad(AxisErrors(**errors), np.random.default_rng(2))


def test_a_bias_is_drawn_once_and_stays() -> None:
    biased = triad(bias=0.5)
    first, later = biased.corrupt((0.0, 0.0, 0.0), 0), biased.corrupt((1.0, 1.0, 1.0), PERIOD_NS)
    assert np.subtract(later, first) == pytest.approx(1.0)
    assert all(axis != 0.0 for axis in first)
    many = [AxisTriad(AxisErrors(bias=0.5), np.random.default_rng(s)) for s in range(1_000)]
    assert np.std([one.corrupt((0.0, 0.0, 0.0), 0) for one in many]) == pytest.approx(0.5, rel=0.05)


@pytest.mark.parametrize("rate", [20, 100])
def test_a_bias_wanders_by_the_root_of_time_whatever_the_rate(rate: int) -> None:
    ends = []
    for seed in range(200):
        wandering = AxisTriad(AxisErrors(walk=0.01), np.random.default_rng(seed))
        for index in range(4 * rate + 1):
            end = wandering.corrupt((0.0, 0.0, 0.0), index * 1_000_000_000 // rate)
        ends.append(end)
    assert np.std(ends) == pytest.approx(0.01 * 2.0, rel=0.1)


def test_readings_come_in_steps_and_end_at_the_limit() -> None:
    stepped = triad(step=0.25, limit=4.0)
    assert stepped.corrupt((1.1, -0.2, 100.0), 0) == (1.0, -0.25, 4.0)
    assert stepped.corrupt((-100.0, 0.0, 0.0), 0)[0] == -4.0


def test_the_hardware_reads_no_more_than_4_g_and_500_degrees_per_second() -> None:
    noisy = noise(HARDWARE)
    hit = replace(imu(force=(300.0, -300.0, 427.0)), angular_velocity=(20.0, -20.0, 0.0))
    reading = read_imu(noisy, hit)
    assert reading.linear_acceleration == pytest.approx((4 * G, -4 * G, 4 * G))
    assert reading.angular_velocity[:2] == pytest.approx((np.radians(500), -np.radians(500)))


def chattering(speed: float) -> np.ndarray:
    noisy = noise(GAZEBO)
    noisy.corrupt(odometry(speed))
    return np.array([read_imu(noisy, imu()).linear_acceleration for _ in range(20_000)])


def test_chatter_leaves_a_standing_rover_alone() -> None:
    assert chattering(0.0) == pytest.approx(np.tile([0.0, 0.0, 9.8], (20_000, 1)))


def test_chatter_grows_with_the_wheels_speed_either_way() -> None:
    rough = [
        (np.linalg.norm(chattering(speed), axis=1) > 15.0).mean() for speed in (0.1, 0.3, 0.8, -0.8)
    ]
    assert rough[0] < rough[1] < rough[2] == rough[3]
    assert 0.10 < rough[1] < 0.25


def test_chatter_carries_the_weight_on_average_and_lifts_off_at_times() -> None:
    forces = chattering(0.8)
    assert forces.mean(axis=0) == pytest.approx([0.0, 0.0, 9.8], abs=0.2)
    assert 0.03 < (np.linalg.norm(forces, axis=1) < 2.0).mean() < 0.12
    assert (forces[:, 2] >= 0.0).all()  # the ground pushes, it never pulls


def test_the_share_of_disturbed_readings_is_as_documented() -> None:
    chatter = ContactChatter(speed=0.3, shape=1.5, friction=0.0)
    rng = np.random.default_rng(0)
    disturbed = [chatter.shake((0.0, 0.0, 9.8), 0.3, rng)[2] != 9.8 for _ in range(20_000)]
    assert np.mean(disturbed) == pytest.approx(1 - np.exp(-1), abs=0.01)


@pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)
def test_imu_noise_leaves_stamp_and_attitude_alone(preset: NoisePreset) -> None:
    noisy = noise(preset)
    noisy.corrupt(odometry(0.5))
    reading = read_imu(noisy, imu(PERIOD_NS))
    assert (reading.stamp_ns, reading.orientation) == (PERIOD_NS, imu().orientation)
    assert reading.linear_acceleration != imu().linear_acceleration


@pytest.mark.parametrize("preset", PRESETS.values(), ids=PRESETS)
def test_the_same_generators_give_the_same_readings(preset: NoisePreset) -> None:
    def readings(seed: int) -> list[Sample]:
        noisy = noise(preset, seed)
        noisy.corrupt(odometry(0.5))
        return [noisy.corrupt(imu(index * PERIOD_NS)) for index in range(20)]

    assert readings(3) == readings(3)
    assert readings(3) != readings(4)


def test_the_imu_does_not_depend_on_how_often_the_lidar_scans() -> None:
    busy, idle = noise(HARDWARE), noise(HARDWARE)
    busy.corrupt(scan(1.0, 2.0, 3.0))
    assert busy.corrupt(imu()) == idle.corrupt(imu())


def test_poses_and_odometry_are_left_alone() -> None:
    pose, told = Pose(0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0)), odometry(0.5)
    noisy = noise(HARDWARE)
    assert noisy.corrupt(pose) is pose
    assert noisy.corrupt(told) is told
