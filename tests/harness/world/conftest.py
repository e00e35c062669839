"""MuJoCo as the oracle: a world compiled on its own, without a rover."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from harness.world.obstacles import Obstacle
from harness.world.world import World

SHAPES = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "ellipsoid": mujoco.mjtGeom.mjGEOM_ELLIPSOID,
}
TERRAIN_GROUP, OBSTACLE_GROUP = 0, 1


class CompiledWorld:
    """Asks MuJoCo where things are."""

    def __init__(self, world: World) -> None:
        spec = mujoco.MjSpec()
        heights, half_size = world.ground.heights, world.ground.half_size
        lowest, relief = float(heights.min()), max(float(np.ptp(heights)), 1e-3)
        spec.add_hfield(
            name="terrain",
            size=[half_size, half_size, relief, 1.0],
            nrow=heights.shape[0],
            ncol=heights.shape[1],
            userdata=((heights - lowest) / relief).ravel().tolist(),
        )
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_HFIELD,
            hfieldname="terrain",
            pos=[0.0, 0.0, lowest],
            group=TERRAIN_GROUP,
        )
        for obstacle in world.obstacles:
            spec.worldbody.add_geom(
                type=SHAPES[obstacle.shape],
                size=[*obstacle.half_size, 0.0][:3],
                pos=list(obstacle.position),
                quat=list(obstacle.quaternion),
                group=OBSTACLE_GROUP,
            )
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        mujoco.mj_kinematics(self.model, self.data)
        self.first_obstacle = 1

    def top_at(self, x: float, y: float, group: int) -> float:
        """Height [m] of what a vertical ray from above meets first; NaN where it meets nothing."""
        groups = np.zeros(6, dtype=np.uint8)
        groups[group] = 1
        start, down = np.array([x, y, 100.0]), np.array([0.0, 0.0, -1.0])
        hit = np.zeros(1, dtype=np.int32)
        distance = mujoco.mj_ray(self.model, self.data, start, down, groups, 1, -1, hit)
        return 100.0 - distance if distance >= 0.0 else float("nan")

    def obstacle_top(self, index: int, obstacle: Obstacle) -> float:
        """Highest point of one obstacle [m], by its distance to a plane far above."""
        geom = self.first_obstacle + index
        rotation = self.data.geom_xmat[geom].reshape(3, 3)
        half = np.array([*obstacle.half_size, 0.0][:3])
        up = rotation[2]
        reach = np.abs(up) @ half if obstacle.shape == "box" else np.linalg.norm(up * half)
        return float(self.data.geom_xpos[geom][2] + reach)


@pytest.fixture
def compiled() -> Callable[[World], CompiledWorld]:
    return CompiledWorld
