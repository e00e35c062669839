"""A planar lidar: exact ranges to terrain and obstacles, REP-117 coded, without noise.

The rover does not see itself: its geoms are in neither of the two groups that are looked at.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.simulation import Simulation
from harness.samples import LaserScan
from harness.sensors.base import Sensor
from harness.sensors.lidar_spec import LidarSpec
from harness.sensors.rays.heightfield_rays import HeightfieldRays
from harness.sensors.rays.obstacle_rays import ObstacleRays

OBSTACLE_GROUP = 1


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
        """Returns the ranges [m] of one revolution, shape (beams,), in a new array.

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


class LidarSensor(Sensor):
    """The lidar as a sensor of the episode."""

    def __init__(self, simulation: Simulation, lidar: Lidar, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        self._lidar = lidar

    def read(self) -> LaserScan:
        """Returns a scan from where the rover is now."""
        self._simulation.refresh_kinematics()
        return LaserScan(self._simulation.time_ns, self._lidar.scan(self._simulation.data))


def beam_bearings(lidar: LidarSpec) -> NDArray[np.float64]:
    """Returns each beam's direction [rad] in the rover's frame: the lidar looks backwards (yaw pi)."""
    return np.remainder(lidar.angles + 2 * math.pi, math.tau) - math.pi
