"""A rover's outline: what it looks like, and where on it a touch can be told from a range."""

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.physics.scene import VISUAL_GROUP
from harness.robots import RoverSpec

ABOVE, SIDE = (0, 1), (0, 2)  # axes of the model frame that are seen
STEP = 1e-3  # [m] along the outline, about
# Directions of a ball, on which the corners of boxes and the ends of cylinders are found too.
TURN, TILT = np.meshgrid(np.linspace(0.0, 2 * np.pi, 24, endpoint=False), np.linspace(0.0, np.pi, 13))
BALL = np.stack([np.sin(TILT) * np.cos(TURN), np.sin(TILT) * np.sin(TURN), np.cos(TILT)], -1)
ROD = np.stack([np.cos(TURN), np.sin(TURN), np.sign(np.cos(TILT))], -1)

Points = NDArray[np.float64]  # shape (n, 2) [m]


def silhouette(rover: RoverSpec, axes: tuple[int, int]) -> list[Points]:
    """Returns convex outlines that together are the rover, in the frame of its footprint [m].

    Args:
        rover: Which; it stands on flat ground.
        axes: ABOVE or SIDE.
    """
    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    data = mujoco.MjData(model)
    data.qpos[:3] = 0.0, 0.0, rover.rest_height
    mujoco.mj_kinematics(model, data)
    hulls = []
    for geom in np.flatnonzero(model.geom_group == VISUAL_GROUP):
        local = _surface(model.geom_type[geom], model.geom_size[geom]).reshape(-1, 3)
        points = local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        hulls.append(points[:, axes][ConvexHull(points[:, axes]).vertices])
    return hulls


def _surface(kind: int, size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points whose hull is a geom, shape (..., 3) [m]."""
    match kind:
        case mujoco.mjtGeom.mjGEOM_BOX:
            return np.asarray(np.sign(BALL) * size)
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return np.asarray(BALL * size)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return np.asarray(BALL * size[0] + np.sign(BALL) * (0.0, 0.0, size[1]))
    return np.asarray(ROD * (size[0], size[0], size[1]))


def shares(rover: RoverSpec, range_min: float, threshold: float) -> tuple[float, float, float]:
    """Returns how much of the outline is too near to the lidar for a range, told, and too far.

    Args:
        rover: Whose outline.
        range_min: Of the lidar [m].
        threshold: For collisions [m]: a touched point that is no nearer raises no alarm.
    """
    distance = np.concatenate([_distance(rover, points) for points, _ in _sides(rover)])
    far = float(np.mean(distance >= threshold))
    told = float(np.mean((distance >= range_min) & (distance < threshold)))
    return 1.0 - told - far, told, far


def untold_strips(
    rover: RoverSpec, range_min: float, threshold: float, start: float, width: float
) -> Iterator[Points]:
    """Yields corners, shape (4, 2) [m], of strips beside the outline where a touch is not told.

    Args:
        rover: Whose outline.
        range_min: Of the lidar [m].
        threshold: For collisions [m].
        start: From the outline to the strip [m].
        width: Of the strip [m].
    """
    for points, outward in _sides(rover):
        distance = _distance(rover, points)
        untold = (distance < range_min) | (distance >= threshold)
        edges = np.flatnonzero(np.diff(untold, prepend=False, append=False)).reshape(-1, 2)
        for first, after in edges:
            ends = points[[first, after - 1]] + outward * start
            yield np.concatenate([ends, ends[::-1] + outward * width])


def _sides(rover: RoverSpec) -> Iterator[tuple[Points, Points]]:
    """The four sides: points at even distances from corner to corner, and the way out."""
    x_min, x_max, y_min, y_max = rover.footprint
    corners = np.array([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        yield np.linspace(start, end, round(length / STEP)), np.array([along[1], -along[0]]) / length


def _distance(rover: RoverSpec, points: Points) -> NDArray[np.float64]:
    return np.asarray(np.hypot(points[:, 0] - rover.lidar_x, points[:, 1]))
