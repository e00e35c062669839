import math

import numpy as np
import pytest

from harness.samples import LaserScan, PlacedScan, Pose
from harness.sensors.scan_points import scan_points
from tests.support.rovers import LEO


def test_beams_of_a_scan_end_where_the_lidar_saw_something() -> None:
    # The lidar looks backwards: its middle beams go to where the rover comes from.
    ranges = np.array([np.inf, 2.0, np.inf], dtype=np.float32)
    north = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), north))
    assert scan_points(placed, LEO) == pytest.approx(np.array([[1.0, 1.0 + 0.174 - 2.0]]), abs=1e-3)
