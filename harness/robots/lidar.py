"""What the lidar of a rover is: its beams and its range limits; where its beams hit something."""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import LIDAR_RANGE_MAX, PlacedScan
from rover_metrics.core.rotation import matrix

Points = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class LidarSpec:
    """Beams over -angle_max..angle_max [rad], both ends included, and the range limits [m].

    The defaults are those of RoboTerrain's gpu_lidar; its first and last beam coincide.
    """

    beams: int = 640
    range_min: float = 0.15
    range_max: float = LIDAR_RANGE_MAX
    angle_max: float = 3.14159

    @property
    def angles(self) -> NDArray[np.float64]:
        """Returns every beam's azimuth in the lidar's frame [rad], counter-clockwise, shape (beams,)."""
        return np.linspace(-self.angle_max, self.angle_max, self.beams)

    def bearings(self, yaw: float) -> NDArray[np.float64]:
        """Returns the azimuths in the frame of a rover whose lidar has that yaw [rad]."""
        return np.remainder(self.angles + (yaw + math.pi), math.tau) - math.pi


def directions(angles: NDArray[np.float64]) -> Points:
    """Returns unit vectors, shape (n, 3), at angles [rad] in the plane of a lidar."""
    return np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])


def scan_points(placed: PlacedScan, rover: RoverSpec) -> Points:
    """Returns where the beams of a scan hit something, shape (k, 2) in the world [m]."""
    ranges = placed.scan.ranges.astype(np.float64)
    hit = np.isfinite(ranges)
    angles = LidarSpec(beams=len(ranges)).angles[hit]
    mount, axes = _lidar_mount(rover)
    in_rover = mount + (ranges[hit, None] * directions(angles)) @ axes.T
    in_world = in_rover @ np.array(matrix(placed.pose.orientation)).T + placed.pose.position
    return np.asarray(in_world[:, :2])


@cache
def _lidar_mount(rover: RoverSpec) -> tuple[Points, Points]:
    """Returns position [m] and rotation of the lidar in the model frame, from the rover's model file."""
    from harness.robots.model import compiled_alone  # noqa: PLC0415 - MuJoCo: not to publish

    _, data = compiled_alone(rover)
    site = data.site("lidar")
    return site.xpos.copy(), site.xmat.reshape(3, 3).copy()
