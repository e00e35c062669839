import math

import numpy as np
import pytest

from harness.samples import LaserScan, PlacedScan, Pose
from harness.sensors.lidar_spec import LidarSpec, scan_points
from tests.support.rovers import LEO


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5, math.pi])
def test_a_lidar_that_is_turned_looks_where_its_yaw_says(yaw: float) -> None:
    """By default backwards."""
    spec = LidarSpec(beams=7, angle_max=3.0)
    bearings = spec.bearings(yaw) if yaw < math.pi else spec.bearings()
    assert np.exp(1j * bearings) == pytest.approx(np.exp(1j * (np.arange(-3.0, 3.5) + yaw)))
    assert np.abs(bearings).max() <= math.pi


def test_beams_of_a_scan_end_where_the_lidar_saw_something() -> None:
    # The lidar looks backwards: its middle beams go to where the rover comes from.
    ranges = np.array([np.inf, 2.0, np.inf], dtype=np.float32)
    north = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), north))
    assert scan_points(placed, LEO) == pytest.approx(np.array([[1.0, 1.0 + 0.174 - 2.0]]), abs=1e-3)
    on_its_left_side = (-math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), on_its_left_side))
    height = 0.79783  # of the lidar over the origin of the model frame
    expected = np.array([[1.0 + 0.174 - 2.0, 1.0 + height]])
    assert scan_points(placed, LEO) == pytest.approx(expected, abs=1e-3)
