"""What a rover looks like from above and from the side: the outlines of all its geoms."""

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.physics.scene import VISUAL_GROUP
from harness.robots import RoverSpec

ABOVE, SIDE = (0, 1), (0, 2)  # axes of the model frame that are seen
Outline = NDArray[np.float64]  # shape (n, 2) [m]


def silhouette(rover: RoverSpec, axes: tuple[int, int]) -> list[Outline]:
    """Convex outlines that together are the rover, in the frame of its footprint on flat ground.

    Args:
        rover: Which.
        axes: ABOVE or SIDE.
    """
    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    data = mujoco.MjData(model)
    data.qpos[:3] = 0.0, 0.0, rover.rest_height
    mujoco.mj_kinematics(model, data)
    seen = [geom for geom in range(model.ngeom) if model.geom_group[geom] == VISUAL_GROUP]
    return [_hull(_corners(model, data, geom)[:, axes]) for geom in seen]


def _corners(model: mujoco.MjModel, data: mujoco.MjData, geom: int) -> Outline:
    """Points whose hull is the geom, shape (n, 3)."""
    size, kind = model.geom_size[geom], model.geom_type[geom]
    if kind == mujoco.mjtGeom.mjGEOM_BOX:
        local = np.array(np.meshgrid(*((-half, half) for half in size))).reshape(3, -1).T
    else:
        local = _round(size, kind)
    return np.asarray(local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])


def _round(size: NDArray[np.float64], kind: int) -> Outline:
    """Points on a cylinder, capsule or ellipsoid along z."""
    turn, tilt = np.meshgrid(
        np.linspace(0.0, 2 * np.pi, 24, endpoint=False), np.linspace(0.0, np.pi, 13)
    )
    ball = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=-1)
    ball = ball.reshape(-1, 3)
    if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
        return ball * size
    if kind == mujoco.mjtGeom.mjGEOM_CAPSULE:
        return np.asarray(ball * size[0] + np.sign(ball[:, 2:]) * (0.0, 0.0, size[1]))
    ring = ball[np.isclose(ball[:, 2], 0.0, atol=1e-9)] * size[0]
    end = np.array((0.0, 0.0, size[1]))
    return np.concatenate([ring - end, ring + end])


def _hull(points: Outline) -> Outline:
    return points[ConvexHull(points).vertices]
