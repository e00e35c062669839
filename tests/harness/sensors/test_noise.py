import numpy as np
import pytest

from harness.samples import Imu, LaserScan, Pose
from harness.sensors.noise import NoiseLevels, WhiteNoise


def noise(seed: int = 1, range_m: float = 0.01) -> WhiteNoise:
    scan_rng, imu_rng = (np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(2))
    return WhiteNoise(NoiseLevels(range_m=range_m), (0.15, 10.0), scan_rng, imu_rng)


def scan(*ranges: float) -> LaserScan:
    return LaserScan(0, np.array(ranges, dtype=np.float32))


def imu() -> Imu:
    return Imu(0, (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 9.8))


def test_ranges_scatter_with_the_stated_deviation() -> None:
    noisy = noise().corrupt(LaserScan(0, np.full(20_000, 5.0, dtype=np.float32)))
    assert isinstance(noisy, LaserScan)
    assert noisy.ranges.dtype == np.float32
    assert noisy.ranges.std() == pytest.approx(0.01, rel=0.03)
    assert noisy.ranges.mean() == pytest.approx(5.0, abs=1e-3)


def test_misses_and_near_returns_stay_what_they_are() -> None:
    noisy = noise().corrupt(scan(np.inf, -np.inf))
    assert isinstance(noisy, LaserScan)
    assert noisy.ranges.tolist() == [np.inf, -np.inf]


def test_range_pushed_over_a_limit_is_coded_as_rep_117_says() -> None:
    noisy = noise(range_m=0.05).corrupt(
        LaserScan(0, np.tile(np.array([0.16, 9.99], dtype=np.float32), 500))
    )
    assert isinstance(noisy, LaserScan)
    near, far = noisy.ranges[::2], noisy.ranges[1::2]
    assert np.isneginf(near).any()
    assert near[np.isfinite(near)].min() >= np.float32(0.15)
    assert np.isposinf(far).any()
    assert far[np.isfinite(far)].max() <= 10.0


def test_imu_noise_touches_force_and_rate_only() -> None:
    noisy = noise().corrupt(imu())
    assert isinstance(noisy, Imu)
    assert noisy.linear_acceleration != imu().linear_acceleration
    assert noisy.angular_velocity != imu().angular_velocity
    assert noisy.orientation == imu().orientation


def test_same_generators_give_the_same_noise() -> None:
    assert noise(3).corrupt(imu()) == noise(3).corrupt(imu())
    assert noise(3).corrupt(imu()) != noise(4).corrupt(imu())


def test_poses_are_left_alone() -> None:
    pose = Pose(0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0, 1.0))
    assert noise().corrupt(pose) is pose
