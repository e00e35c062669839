"""The grounds of the manoeuvres: a nearly level floor, a ramp, a saddle, and things to drive over.

A seed gives the floor its unevenness and the manoeuvre its heading relative to the grid, so that no
result hangs on one lucky triangle. Obstacles stand ahead of a rover that faces that heading.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from harness.base.streams import VALIDATION_GROUND
from harness.world.heightfield import Field, Heightfield, fractal
from harness.world.obstacles import Obstacle, ObstacleKind, Shape, orientation
from harness.world.world import World

HALF_SIZE, CELL = 6.0, 0.1  # [m]
PLANE_HALF_SIZE, PLANE_CELL = 60, 1.0  # [m]
UNEVENNESS = 0.0005  # [m] RMS: a good concrete floor
RAMP_START, RAMP_BEND = 0.6, 0.8  # [m] ahead of the origin; length over which the incline grows


@dataclass(frozen=True, slots=True)
class Course:
    """A world and the heading [rad] in which a rover is set down in it."""

    world: World
    heading: float


def flat(half_size: float = PLANE_HALF_SIZE, cell: float = PLANE_CELL, heading: float = 0.0) -> Course:
    """Returns a level plane.

    Args:
        half_size: Half its side length [m].
        cell: Distance of its vertices [m].
        heading: Of the rover at the start [rad].
    """
    count = 2 * round(half_size / cell) + 1
    return Course(World("check", Heightfield(np.zeros((count, count)), cell), (), 0, 0.0), heading)


def floor(seed: int, *blocks: Obstacle) -> Course:
    """Returns a level floor, as even as a good concrete one, with blocks where the rover sees them."""
    heading, heights = _heading_and_floor(seed)
    return Course(_world(heights, seed, tuple(_turned(one, heading) for one in blocks)), heading)


def ramp(seed: int, incline: float) -> Course:
    """Returns a floor that bends up into an incline [rad] ahead of the rover."""
    heading, heights = _heading_and_floor(seed)
    x, y = _grid()
    along = x * math.cos(heading) + y * math.sin(heading) - RAMP_START
    bend = np.clip(along, 0.0, RAMP_BEND)
    rise = bend**2 / (2 * RAMP_BEND) + np.maximum(along - RAMP_BEND, 0.0)
    return Course(_world(heights + math.tan(incline) * rise, seed), heading)


def saddle(seed: int, twist: float) -> Course:
    """Returns a surface z = twist * x * y [1/m] about the origin, seen from the rover's heading.

    It lifts two diagonal wheels and lowers the others, which turns the rockers against each other
    and leaves the body level. The heading stays within 3 deg of the grid, whose triangles would
    otherwise bend the surface.
    """
    x, y = _grid()
    sign = 1.0 if _rng(seed).random() < 0.5 else -1.0
    reach = np.exp(-((x**2 + y**2) / 2.0))  # flattens towards the edge
    heading = math.radians(_rng(seed).uniform(-3.0, 3.0))
    return Course(_world(sign * twist * x * y * reach, seed), heading)


def block(shape: Shape, half_size: tuple[float, ...], x: float, y: float = 0.0) -> Obstacle:
    """Returns a solid thing that stands on the floor, as seen from the rover.

    Args:
        shape: As in `Obstacle`.
        half_size: As in `Obstacle` [m].
        x: Of its centre ahead of the origin [m].
        y: To the left [m].
    """
    position = (x, y, half_size[-1])
    return Obstacle(kind=ObstacleKind.ROCK, shape=shape, half_size=half_size, position=position)


def _turned(obstacle: Obstacle, heading: float) -> Obstacle:
    (x, y, z), c, s = obstacle.position, math.cos(heading), math.sin(heading)
    position = c * x - s * y, s * x + c * y, z
    return replace(obstacle, position=position, quaternion=orientation(heading))


def _heading_and_floor(seed: int) -> tuple[float, Field]:
    rng, (x, _) = _rng(seed), _grid()
    heading = rng.uniform(-math.pi, math.pi)
    return heading, UNEVENNESS * fractal(rng, x.shape, cell=CELL, longest=2.0, shortest=0.3)


def _rng(seed: int) -> np.random.Generator:
    return np.random.default_rng([seed, VALIDATION_GROUND])


def _grid() -> tuple[Field, Field]:
    axis = np.linspace(-HALF_SIZE, HALF_SIZE, round(2 * HALF_SIZE / CELL) + 1)
    x, y = np.meshgrid(axis, axis)
    return x, y


def _world(heights: Field, seed: int, obstacles: tuple[Obstacle, ...] = ()) -> World:
    return World("validation", Heightfield(heights, CELL), obstacles, seed, 0.0)
