"""Obstacles: solid things that stand on a terrain, as MuJoCo geoms describe them, and where to put them.

A rock is small enough to be driven over; a hazard (post, boulder, wall) is not to be touched at all.
"""

import math
from dataclasses import dataclass
from enum import Enum, auto
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Heightfield

TRIES_PER_POINT = 50

Shape = Literal["ellipsoid", "box", "cylinder"]
Points = NDArray[np.float64]  # shape (k, 2): x, y in the world [m]


class ObstacleKind(Enum):
    """What a contact with the obstacle means."""

    ROCK = auto()
    HAZARD = auto()


@dataclass(frozen=True, kw_only=True)
class Obstacle:
    """One geom in the world frame.

    Attributes:
        half_size: Box: half lengths [m]; ellipsoid: semi-axes [m]; cylinder: radius, half height [m].
        position: Centre x, y, z [m].
        quaternion: Orientation w, x, y, z.
    """

    kind: ObstacleKind
    shape: Shape
    half_size: tuple[float, ...]
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Form:
    """An obstacle before it has a place.

    Attributes:
        half_size: As in `Obstacle`.
        sink: How deep the lowest point of the upright form goes into the ground [m].
        yaw: Heading about the vertical [rad].
        tilt: Lean about the form's own x axis [rad].
    """

    kind: ObstacleKind
    shape: Shape
    half_size: tuple[float, ...]
    sink: float = 0.0
    yaw: float = 0.0
    tilt: float = 0.0


def place(form: Form, ground: Heightfield, x: float, y: float) -> Obstacle:
    """Stands a form on the ground at a point [m]."""
    z = ground.height_at(x, y) + form.half_size[-1] - form.sink
    return Obstacle(
        kind=form.kind,
        shape=form.shape,
        half_size=form.half_size,
        position=(x, y, z),
        quaternion=orientation(form.yaw, form.tilt),
    )


def orientation(yaw: float, tilt: float = 0.0) -> tuple[float, float, float, float]:
    """Quaternion w, x, y, z of a turn about z by `yaw` after one about x by `tilt` [rad]."""
    cy, sy = math.cos(0.5 * yaw), math.sin(0.5 * yaw)
    ct, st = math.cos(0.5 * tilt), math.sin(0.5 * tilt)
    return (cy * ct, cy * st, sy * st, sy * ct)


def scatter(
    rng: np.random.Generator,
    count: int,
    *,
    reach: float,
    spacing: float,
    keep_out: float,
) -> Points:
    """Scatters points at random, none too close to another (dart throwing).

    Args:
        rng: Source of randomness.
        count: How many points; fewer come back where there is no room left.
        reach: Largest |x| and |y| [m].
        spacing: Smallest distance between two points [m].
        keep_out: Radius of the circle around the origin that stays free [m].
    """
    points: list[Points] = []
    for dart in rng.uniform(-reach, reach, size=(count * TRIES_PER_POINT, 2)):
        if len(points) == count:
            break
        if np.hypot(*dart) < keep_out:
            continue
        if points and np.hypot(*(np.asarray(points) - dart).T).min() < spacing:
            continue
        points.append(dart)
    return np.array(points).reshape(-1, 2)
