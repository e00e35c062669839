"""Outlines: what an obstacle and a scan look like from above."""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.report.recorder import PlacedScan
from harness.robots import RoverSpec
from harness.sensors.lidar_spec import LidarSpec
from harness.world.obstacles import Obstacle

OUTLINE_POINTS = 24

Points = NDArray[np.float64]  # shape (k, 2): x, y in the world [m]


def outline(obstacle: Obstacle) -> Points:
    """Silhouette of an obstacle seen from above, what is in the ground included.

    For each direction in the plane the point of the body that lies furthest in it (the support
    mapping of convex bodies): these points are the silhouette's corners, counter-clockwise.
    """
    angles = np.linspace(0.0, math.tau, OUTLINE_POINTS, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    rotation = _rotation(obstacle.quaternion)
    support = _furthest(obstacle, directions @ rotation) @ rotation.T
    return np.asarray(support[:, :2] + obstacle.position[:2])


def _furthest(obstacle: Obstacle, directions: Points) -> Points:
    """Points of the body that lie furthest in the given directions, all in its own frame."""
    half = np.array(obstacle.half_size)
    match obstacle.shape:
        case "box":
            return np.asarray(np.sign(directions) * half)
        case "ellipsoid":
            lengths = np.linalg.norm(half * directions, axis=1, keepdims=True)
            return np.asarray(half**2 * directions / lengths)
        case "cylinder":
            radial = np.linalg.norm(directions[:, :2], axis=1, keepdims=True)
            disc = half[0] * directions[:, :2] / np.maximum(radial, 1e-12)
            return np.column_stack([disc, np.sign(directions[:, 2]) * half[1]])


def scan_points(placed: PlacedScan, rover: RoverSpec) -> Points:
    """Where the beams of a scan hit something."""
    ranges = placed.scan.ranges.astype(np.float64)
    hit = np.isfinite(ranges)
    angles = LidarSpec(beams=len(ranges)).angles[hit]
    beams = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    mount, axes = _lidar_mount(rover)
    in_rover = mount + (ranges[hit, None] * beams) @ axes.T
    x, y, z, w = placed.pose.orientation
    in_world = in_rover @ _rotation((w, x, y, z)).T + placed.pose.position
    return np.asarray(in_world[:, :2])


def _lidar_mount(rover: RoverSpec) -> tuple[Points, Points]:
    """Position [m] and rotation of the lidar in the model frame, from the rover's model file."""
    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    body, site = data.body("rover"), data.site("lidar")
    to_rover = body.xmat.reshape(3, 3).T
    return to_rover @ (site.xpos - body.xpos), to_rover @ site.xmat.reshape(3, 3)


def _rotation(quaternion: tuple[float, float, float, float]) -> Points:
    """Rotation matrix of a quaternion w, x, y, z."""
    flat = np.empty(9)
    mujoco.mju_quat2Mat(flat, np.array(quaternion))
    return flat.reshape(3, 3)
