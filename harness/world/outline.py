"""What an obstacle looks like from above: its silhouette and how far it reaches in a direction."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.world.obstacles import Obstacle

OUTLINE_POINTS = 24

Points = NDArray[np.float64]  # shape (k, 2): x, y in the world [m]


def outline(obstacle: Obstacle) -> Points:
    """Silhouette of an obstacle seen from above, what is in the ground included.

    For each direction in the plane the point of the body that lies furthest in it (the support
    mapping of convex bodies): these points are the silhouette's corners, counter-clockwise.
    """
    angles = np.linspace(0.0, math.tau, OUTLINE_POINTS, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray(_support(obstacle, directions) + obstacle.position[:2])


def half_extent(obstacle: Obstacle, direction: float) -> float:
    """How far an obstacle reaches from its centre in a direction [rad], seen from above [m]."""
    ahead = np.array([[math.cos(direction), math.sin(direction)]])
    return float((_support(obstacle, ahead) * ahead).sum())


def _support(obstacle: Obstacle, directions: Points) -> Points:
    """The body's furthest points in directions of the plane, seen from its centre."""
    rotation = rotation_matrix(obstacle.quaternion)
    upright = np.column_stack([directions, np.zeros(len(directions))])
    return np.asarray((_furthest(obstacle, upright @ rotation) @ rotation.T)[:, :2])


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


def rotation_matrix(quaternion: tuple[float, float, float, float]) -> Points:
    """Rotation matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = quaternion
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
