"""A planar lidar: exact ranges to terrain and obstacles, REP-117 coded, without noise.

The rover does not see itself: its geoms are in neither of the two groups that are looked at.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.sensors.heightfield_rays import HeightfieldRays
from harness.sensors.obstacle_rays import ObstacleRays

OBSTACLE_GROUP = 1


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
            message = f"a lidar needs 2 beams or more, not {self.beams}"
            raise UsageError(message)
        if not 0.0 <= self.range_min < self.range_max < np.inf:
            message = f"range_min {self.range_min:g} m, range_max {self.range_max:g} m: not a range"
            raise UsageError(message)

    @property
    def angles(self) -> NDArray[np.float64]:
        """Azimuth of every beam in the lidar's frame [rad], counter-clockwise, shape (beams,)."""
        return np.linspace(-self.angle_max, self.angle_max, self.beams)


class Lidar:
    """The lidar at a site of a model; beams lie in the site's xy plane, azimuth 0 along its x."""

    def __init__(
        self, model: mujoco.MjModel, spec: LidarSpec | None = None, site_name: str = "lidar"
    ) -> None:
        self.spec = spec or LidarSpec()
        self._site = model.site(site_name).id
        self._terrain = HeightfieldRays.from_model(model)
        self._obstacles = ObstacleRays.from_model(model, OBSTACLE_GROUP)
        angles = self.spec.angles
        self._beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
        self._fan = np.array([angles[0], angles[1] - angles[0], self.spec.range_max])
        self._pose = np.empty((4, 3))
        self._directions = np.empty_like(self._beams)
        self._distances = np.empty_like(angles)

    def scan(self, data: mujoco.MjData) -> NDArray[np.float32]:
        """Ranges [m] of one revolution, shape (beams,), in a new array.

        +inf: nothing within range_max; -inf: something nearer than range_min. The poses in `data`
        must be those of its qpos: after mj_step, call mj_kinematics first.
        """
        pose, directions, distances = self._pose, self._directions, self._distances
        pose[0] = data.site_xpos[self._site]
        pose[1:] = data.site_xmat[self._site].reshape(3, 3)
        np.matmul(self._beams, pose[1:].T, out=directions)
        distances.fill(np.inf)
        self._obstacles.cast(data, pose, directions, self._fan, distances)
        # Obstacles first: the terrain is then walked no further than to them.
        self._terrain.cast(pose[0], directions, self.spec.range_max, distances)
        distances[distances < self.spec.range_min] = -np.inf
        return distances.astype(np.float32)
