"""A rover's outline: what it looks like, and where on it a touch shows in a range."""

from collections.abc import Iterator

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull

from harness.robots import RoverSpec
from harness.robots.model import SEEN_GROUP, read_model

ABOVE, SIDE = (0, 1), (0, 2)  # axes of the model frame that are seen
STEP = 1e-3  # [m] along the outline, about
# Directions of a ball, on which the corners of boxes and the ends of cylinders are found too.
TURN, TILT = np.meshgrid(np.linspace(0.0, 2 * np.pi, 24, endpoint=False), np.linspace(0.0, np.pi, 13))
BALL = np.stack([np.sin(TILT) * np.cos(TURN), np.sin(TILT) * np.sin(TURN), np.cos(TILT)], -1)
ROD = np.stack([np.cos(TURN), np.sin(TURN), np.sign(np.cos(TILT))], -1)

Points = NDArray[np.float64]  # shape (n, 2) [m]
Span = tuple[float, float]  # range_min and a threshold [m]: a touch between them raises an alarm


def silhouette(rover: RoverSpec, axes: tuple[int, int]) -> list[Points]:
    """Returns convex outlines of a rover on flat ground in its frame [m]; `axes` are ABOVE or SIDE."""
    model = read_model(rover).compile()
    data = mujoco.MjData(model)
    data.qpos[:3] = 0.0, 0.0, rover.rest_height
    mujoco.mj_kinematics(model, data)
    hulls = []
    for geom in np.flatnonzero(model.geom_group == SEEN_GROUP):
        local = _surface(model.geom_type[geom], model.geom_size[geom]).reshape(-1, 3)
        points = local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
        hulls.append(points[:, axes][ConvexHull(points[:, axes]).vertices])
    return hulls


def _surface(kind: int, size: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points whose hull is a geom, shape (..., 3) [m]."""
    match mujoco.mjtGeom(int(kind)):
        case mujoco.mjtGeom.mjGEOM_BOX | mujoco.mjtGeom.mjGEOM_MESH:  # the size of a mesh is its box's
            return np.asarray(np.sign(BALL) * size)
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            return np.asarray(BALL * size[0])
        case mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return np.asarray(BALL * size)
        case mujoco.mjtGeom.mjGEOM_CAPSULE:
            return np.asarray(BALL * size[0] + np.sign(BALL) * (0.0, 0.0, size[1]))
    return np.asarray(ROD * (size[0], size[0], size[1]))


def shares(rover: RoverSpec, span: Span) -> tuple[float, float, float]:
    """Returns the shares of the outline where a touch is too near, raises an alarm, and is too far."""
    distance = np.concatenate([distance for _, distance, _ in _sides(rover)])
    far = float(np.mean(distance >= span[1]))
    between = float(np.mean((distance >= span[0]) & (distance < span[1])))
    return 1.0 - between - far, between, far


def silent_strips(rover: RoverSpec, span: Span, start: float, width: float) -> Iterator[Points]:
    """Yields corners, shape (4, 2) [m], of strips beside the outline where a touch raises no alarm.

    Args:
        rover: Whose outline.
        span: Distances of touches that raise an alarm.
        start: From the outline to the strip [m].
        width: Of the strip [m].
    """
    for points, distance, outward in _sides(rover):
        silent = (distance < span[0]) | (distance >= span[1])
        edges = np.flatnonzero(np.diff(silent, prepend=False, append=False)).reshape(-1, 2)
        for ends in points[edges - (0, 1)]:
            inner = ends + outward * start
            yield np.concatenate([inner, inner[::-1] + outward * width])


def _sides(rover: RoverSpec) -> Iterator[tuple[Points, NDArray[np.float64], Points]]:
    """The four sides: points at even distances, how far each is from the lidar, and the way out."""
    x_min, x_max, y_min, y_max = rover.footprint
    corners = np.array([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])
    for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        along = end - start
        length = float(np.hypot(*along))
        points = np.linspace(start, end, round(length / STEP))
        outward = np.array([along[1], -along[0]]) / length
        yield points, np.hypot(points[:, 0] - rover.lidar_x, points[:, 1] - rover.lidar_y), outward
