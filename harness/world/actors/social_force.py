"""The social force model of pedestrians: Helbing and Molnar, Phys. Rev. E 51, 4282 (1995).

One speeds up towards where one wants to be, and is pushed away, exponentially with the gap, by other
bodies (the rover is one) and by walls. Forces are accelerations, of a body of unit mass.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.world.actors.room import from_wall
from harness.world.obstacles import Points

Vector = NDArray[np.float64]

RELAXATION = 0.5  # [s] in which the wanted velocity is taken up
BODY_PUSH, BODY_RANGE = 7.0, 0.3  # [m/s^2] at a gap of 0 (V/sigma = 2.1/0.3), and [m]
WALL_PUSH, WALL_RANGE = 50.0, 0.2  # likewise (U/R = 10/0.2)
SIGHT = 2.0  # [m] beyond which a gap counts as none
HURRY = 1.3  # times the wanted speed that nobody exceeds
BEHIND = 0.5  # share of a push from behind, outside 100 degrees to either side
FIELD_OF_VIEW = math.cos(math.radians(100.0))


def step(
    place: Vector,
    velocity: Vector,
    wanted: Vector,
    *,
    radius: float,
    bodies: Sequence[tuple[float, float, float]],
    walls: Sequence[Points],
    seconds: float,
) -> tuple[Vector, Vector]:
    """Returns place [m] and velocity [m/s] a time step later.

    Args:
        place: In the world, shape (2,) [m].
        velocity: Likewise [m/s].
        wanted: The velocity that one would have alone [m/s].
        radius: Of the body [m].
        bodies: x, y and radius of the others [m].
        walls: Outlines of what stands around, counter-clockwise.
        seconds: Of the step.
    """
    force = (wanted - velocity) / RELAXATION
    for x, y, size in bodies:
        away = place - (x, y)
        distance = math.hypot(*away)
        gap = distance - size - radius
        if distance > 0.0 and gap < SIGHT:
            push = BODY_PUSH * math.exp(-max(gap, -radius) / BODY_RANGE) * away / distance
            force = force + push * _share(wanted, push)
    for wall in walls:
        distances, feet = from_wall(place[None], wall)
        gap, away = float(distances[0]) - radius, place - feet[0]
        length = math.hypot(*away)
        if 0.0 < gap < SIGHT and length > 0.0:
            force = force + WALL_PUSH * math.exp(-gap / WALL_RANGE) * away / length
    velocity = velocity + seconds * force
    speed, most = math.hypot(*velocity), HURRY * math.hypot(*wanted)
    if speed > most:
        velocity = velocity * (most / speed)
    return place + seconds * velocity, velocity


def _share(wanted: Vector, push: Vector) -> float:
    """How much a push counts by where it comes from: what is behind is hardly seen."""
    ahead = float(-wanted @ push)
    seen = ahead >= FIELD_OF_VIEW * math.hypot(*wanted) * math.hypot(*push)
    return 1.0 if seen else BEHIND
