"""A planar lidar: exact ranges to terrain, obstacles and other rovers, REP-117 coded, without noise.

The rover does not see itself: its geoms are in neither of the two groups that are looked at. Of another
rover it sees what collides.
"""

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import entry
from harness.physics.aside import Errand
from harness.robots.lidar import LidarSpec, directions
from harness.sensors.rays.bundle import RayBundle, Surroundings, cast_rays_of


class Lidar:
    """The lidar at a model's site; beams lie in the site's xy plane, azimuth 0 along its x.

    Args:
        model: Of the scene.
        spec: Its beams and limits.
        site: The site's name.
        others: Indices of the geoms of other rovers.
    """

    def __init__(
        self, model: mujoco.MjModel, spec: LidarSpec, site: str = "lidar", others: Sequence[int] = ()
    ) -> None:
        self.spec = spec
        self._site = model.site(site).id
        self.surroundings, self._model = Surroundings(model, others), model
        self._fan, self._pose = self._bundle(), np.empty((4, 3))

    def _bundle(self) -> RayBundle:
        beams = directions(self.spec.angles)
        return RayBundle(self.surroundings, beams, self.spec.range_max)

    def aside(self, model: mujoco.MjModel) -> tuple[Errand, NDArray[np.float64]]:
        """Returns a scan that the thread which simulates ahead can make, and where its distances come.

        It is for scenes in which no meshes may be met.
        """
        rays = self._bundle()

        def passed(data: mujoco.MjData) -> tuple[int, int]:
            return entry(cast_rays_of), rays.passed_at(self._site, model, data)

        return Errand(passed), rays.distances

    def scan(self, data: mujoco.MjData) -> NDArray[np.float32]:
        """Returns the ranges [m] of one revolution, shape (beams,), in a new array.

        +inf: nothing within range_max; -inf: something nearer than range_min. The poses in `data` become
        those of its qpos: after mj_step they are one step old.
        """
        if self.surroundings.has_meshes:
            pose = self._pose
            mujoco.mj_kinematics(self._model, data)
            pose[0], pose[1:] = data.site_xpos[self._site], data.site_xmat[self._site].reshape(3, 3)
            return self.coded(self._fan.cast(data, pose))
        cast_rays_of(self._fan.passed_at(self._site, self._model, data))
        return self.coded(self._fan.distances)

    def coded(self, distances: NDArray[np.float64]) -> NDArray[np.float32]:
        """Returns distances [m] as ranges of a scan: -inf below range_min; the argument changes, too."""
        distances[distances < self.spec.range_min] = -np.inf
        return distances.astype(np.float32)
