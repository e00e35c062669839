"""What a lidar is: its beams and its range limits. No physics in here."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError


@dataclass(frozen=True, kw_only=True)
class LidarSpec:
    """Beams over -angle_max..angle_max [rad], both ends included, and the range limits [m].

    The defaults are those of RoboTerrain's gpu_lidar; its first and last beam coincide.
    """

    beams: int = 640
    range_min: float = 0.15
    range_max: float = 10.0
    angle_max: float = 3.14159

    def __post_init__(self) -> None:
        if self.beams < 2:
            raise UsageError(f"a lidar needs 2 beams or more, not {self.beams}")
        if not 0.0 <= self.range_min < self.range_max < np.inf:
            raise UsageError(
                f"range_min {self.range_min:g} m, range_max {self.range_max:g} m: not a range"
            )

    @property
    def angles(self) -> NDArray[np.float64]:
        """Returns every beam's azimuth in the lidar's frame [rad], counter-clockwise, shape (beams,)."""
        return np.linspace(-self.angle_max, self.angle_max, self.beams)

    @property
    def bearings(self) -> NDArray[np.float64]:
        """Returns the azimuths in the rover's frame [rad], whose lidar looks backwards (yaw pi)."""
        return np.remainder(self.angles + 2 * math.pi, math.tau) - math.pi
