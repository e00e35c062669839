import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.drivers.point_nav import clipped, limits, observed, visible, way_to
from harness.samples import Imu, LaserScan, Odometry, Pose, Quaternion, Sample, Twist


def quaternion(roll: float, pitch: float, yaw: float) -> Quaternion:
    x, y, z, w = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat().tolist()
    return x, y, z, w


@pytest.mark.parametrize(
    ("goal", "yaw", "expected"),
    [
        ((4.0, 2.0), 0.0, (3.0, 0.0)),
        ((1.0, 6.0), 0.0, (4.0, math.pi / 2)),
        ((1.0, 6.0), math.pi / 2, (4.0, 0.0)),
        ((-2.0, 2.0 - 1e-9), -3.0, (3.0, 3.0 - math.pi)),
    ],
)
def test_the_way_to_a_goal_is_seen_from_the_rover(
    goal: tuple[float, float], yaw: float, expected: tuple[float, float]
) -> None:
    pose = Pose(0, (1.0, 2.0, 0.3), quaternion(0.1, 0.05, yaw))
    assert way_to(goal, pose) == pytest.approx(expected, abs=1e-8)


def test_ranges_become_numbers_and_nothing_is_nearer_than_what_is_too_near() -> None:
    ranges = np.array([np.inf, -np.inf, np.nan, 3.5], np.float32)
    assert visible(ranges, 10.0).tolist() == [10.0, 0.0, 10.0, 3.5]
    assert np.isnan(ranges[2])  # the scan itself is left alone


def test_point_nav_observes_the_samples_in_their_order_and_within_its_space() -> None:
    imu = Imu(0, quaternion(0.2, -0.1, 3.0), (0.1, 0.2, 900.0), (1.0, -2.0, 9.5))
    readings: dict[type[Sample], Sample] = {
        LaserScan: LaserScan(0, np.array([1.0, 2.0, np.inf], np.float32)),
        Imu: imu,
        Pose: Pose(0, (0.0, 0.0, 0.0), quaternion(0.0, 0.0, 0.5)),
        Odometry: Odometry(0, 7.0, 8.0, 9.0, Twist(0.3, -0.4)),
    }
    values = observed(readings, (0.0, 300.0), 10.0)
    seen = {name: clipped(values[name], *ends) for name, ends in limits(10.0).items()}
    bearing = math.pi / 2 - 0.5
    expected = {
        "lidar": [1.0, 2.0, 10.0],
        "goal": [100.0, math.sin(bearing), math.cos(bearing)],  # 300 m is beyond the space
        "imu": [1.0, -2.0, 9.5, 0.1, 0.2, 50.0, 0.2, -0.1],
        "velocities": [0.3, -0.4],
    }
    assert seen.keys() == expected.keys()
    for name, numbers in expected.items():
        assert seen[name] == pytest.approx(numbers, rel=1e-6), name
        assert seen[name].dtype == np.float32
