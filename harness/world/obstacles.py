"""Obstacles: solid things that stand on a terrain, as MuJoCo geoms describe them, and where to put them.

A rock is small enough to be driven over; a hazard (post, boulder, wall) is not to be touched at all; a
deck is ground that no heightfield can show, as that of a bridge.
"""

import math
from dataclasses import dataclass, replace
from enum import Enum, auto
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Heightfield
from rover_metrics.core import rotation

HEADROOM = 1.0  # [m] between ground and what a rover with its lidar passes under
OUTLINE_POINTS = 24
TRIES_PER_POINT = 50
Points = NDArray[np.float64]  # shape (k, 2): x, y in the world [m]

Color = tuple[float, float, float, float]  # RGBA, 0..1
Shape = Literal["ellipsoid", "box", "cylinder", "convex", "surface"]


class ObstacleKind(Enum):
    """What a contact with the obstacle means."""

    ROCK = auto()
    HAZARD = auto()
    DECK = auto()


@dataclass(frozen=True)
class Obstacle:
    """One geom in the world frame."""

    kind: ObstacleKind
    shape: Shape
    # box: half lengths [m]; ellipsoid: semi-axes [m]; cylinder: radius, half height [m]; convex,
    # surface: half lengths of the box around it
    half_size: tuple[float, ...]
    # centre x, y, z [m], of the box around it if it is convex or a surface
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)  # orientation w, x, y, z
    # from the centre, x, y, z [m], of a convex one, which is their hull, and of a surface, which is only
    # seen
    corners: tuple[tuple[float, float, float], ...] = ()
    faces: tuple[tuple[int, ...], ...] = ()  # the triangles of a surface, by the numbers of its corners
    color: Color | None = None  # how a file says that it looks


def surface(points: NDArray[np.float64], faces: NDArray[np.int64]) -> Obstacle:
    """Returns triangles of a deck that are seen and not touched.

    Args:
        points: Corners in the world [m], shape (n, 3).
        faces: Their numbers, shape (f, 3).
    """
    hull = convex(ObstacleKind.DECK, points)
    return replace(hull, shape="surface", faces=tuple(map(tuple, faces.tolist())))


def convex(kind: ObstacleKind, points: NDArray[np.float64]) -> Obstacle:
    """Returns the convex hull of points in the world [m], shape (n, 3)."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle = 0.5 * (low + high)
    corners = tuple((x, y, z) for x, y, z in (points - middle).tolist())
    x, y, z = middle.tolist()
    return Obstacle(kind, "convex", tuple((high - middle).tolist()), (x, y, z), corners=corners)


@dataclass(frozen=True)
class Form:
    """An obstacle before it has a place."""

    kind: ObstacleKind
    shape: Shape
    half_size: tuple[float, ...]  # as in `Obstacle`
    sink: float = 0.0  # how deep the lowest point of the upright form goes into the ground [m]
    yaw: float = 0.0  # heading about the vertical [rad]
    tilt: float = 0.0  # lean about the form's own x axis [rad]


def place(form: Form, ground: Heightfield, x: float, y: float) -> Obstacle:
    """Returns a form that stands on the ground at a point [m].

    Args:
        form: What is to stand there.
        ground: On which it stands.
        x: In the world [m].
        y: In the world [m].
    """
    position = (x, y, ground.height_at(x, y) + form.half_size[-1] - form.sink)
    quaternion = orientation(form.yaw, form.tilt)
    return Obstacle(form.kind, form.shape, form.half_size, position, quaternion)


def orientation(yaw: float, tilt: float = 0.0) -> tuple[float, float, float, float]:
    """Returns the quaternion w, x, y, z of a turn about z by `yaw` after one about x by `tilt` [rad]."""
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    ct, st = math.cos(0.5 * tilt), math.sin(0.5 * tilt)
    return (cy * ct, cy * st, sy * st, sy * ct)


def scatter(
    rng: np.random.Generator, count: int, *, reach: float, spacing: float, keep_out: float
) -> Points:
    """Returns points at random, none too close to another (dart throwing).

    Args:
        rng: Source of randomness.
        count: How many points; fewer come back where there is no room left.
        reach: Largest |x| and |y| [m].
        spacing: Smallest distance between two points [m].
        keep_out: Radius of the circle around the origin that stays free [m].
    """
    points, placed = np.empty((count, 2)), 0
    for dart in rng.uniform(-reach, reach, size=(count * TRIES_PER_POINT, 2)):
        if placed == count:
            break
        if np.hypot(*dart) < keep_out:
            continue
        if (np.hypot(*(points[:placed] - dart).T) < spacing).any():
            continue
        points[placed] = dart
        placed += 1
    return points[:placed]


def outline(obstacle: Obstacle) -> Points:
    """Returns the silhouette of an obstacle seen from above, what is in the ground included.

    For each direction in the plane the point of the body that lies furthest in it (the support
    mapping of convex bodies): these points are the silhouette's corners, counter-clockwise.
    """
    angles = np.linspace(0.0, math.tau, OUTLINE_POINTS, endpoint=False)
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray(_support(obstacle, directions) + obstacle.position[:2])


def top(obstacle: Obstacle) -> float:
    """Returns the height of an obstacle's highest point in the world [m]."""
    return _level(obstacle, 1.0)


def bottom(obstacle: Obstacle) -> float:
    """Returns the height of an obstacle's lowest point in the world [m]."""
    return _level(obstacle, -1.0)


def _level(obstacle: Obstacle, upward: float) -> float:
    rotation = rotation_matrix(obstacle.quaternion)
    direction = np.array([[0.0, 0.0, upward]])
    return float((_furthest(obstacle, direction @ rotation) @ rotation.T)[0, 2] + obstacle.position[2])


def half_extent(obstacle: Obstacle, direction: float) -> float:
    """Returns how far it reaches from its centre in a direction [rad], seen from above [m]."""
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
        case "convex" | "surface":
            corners = np.array(obstacle.corners)
            return np.asarray(corners[np.argmax(directions @ corners.T, axis=1)])


def rotation_matrix(quaternion: tuple[float, float, float, float]) -> Points:
    """Returns the rotation matrix of a unit quaternion w, x, y, z."""
    w, x, y, z = quaternion
    return np.array(rotation.matrix((x, y, z, w)))
