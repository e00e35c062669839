"""A fan of beams against the obstacles of a model, wherever their bodies stand at that moment.

mj_multiRay asks every beam about every geom; a planar fan can go from obstacle to beams instead,
with the same hits.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.sensors.rays.obstacle_kernel import BOX, CYLINDER, ELLIPSOID, cast_fan

KINDS = {
    int(mujoco.mjtGeom.mjGEOM_BOX): BOX,
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): CYLINDER,
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): ELLIPSOID,
}


@dataclass(frozen=True, eq=False)
class ObstacleRays:
    """The obstacles of a model prepared for ray casting; see cast_fan for the arrays."""

    obstacles: NDArray[np.int64]
    sizes: NDArray[np.float64]

    @classmethod
    def from_model(cls, model: mujoco.MjModel, group: int) -> "ObstacleRays":
        """Takes the geoms of one group.

        Raises:
            ValueError: One of them is neither box, cylinder nor ellipsoid.
        """
        geoms = np.flatnonzero(model.geom_group == group)
        for geom in geoms:
            if int(model.geom_type[geom]) not in KINDS:
                message = (
                    f"obstacle '{model.geom(geom).name}' has a shape that the lidar cannot see; "
                    "available: box, cylinder, ellipsoid"
                )
                raise ValueError(message)
        kinds = np.array([KINDS[int(model.geom_type[geom])] for geom in geoms])
        return cls(
            obstacles=np.column_stack([geoms, kinds]).astype(np.int64),
            sizes=np.column_stack([model.geom_size[geoms], model.geom_rbound[geoms]]),
        )

    def cast(
        self,
        data: mujoco.MjData,
        pose: NDArray[np.float64],
        directions: NDArray[np.float64],
        fan: NDArray[np.float64],
        ranges: NDArray[np.float64],
    ) -> None:
        """Lowers `ranges` [m] where an obstacle is nearer; the beams lie in the pose's xy plane."""
        if self.obstacles.size:
            positions, matrices = data.geom_xpos, data.geom_xmat
            cast_fan(self.obstacles, self.sizes, positions, matrices, pose, directions, fan, ranges)
