"""The social force model of pedestrians: Helbing and Molnar, Phys. Rev. E 51, 4282 (1995).

One speeds up towards where one wants to be, and is pushed away, exponentially with the gap, by other
bodies (the rover is one) and by walls. Forces are accelerations, of a body of unit mass. A walker heads
for the way points of a random walk, but keeps out of the way of the rover, of others and of walls.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from harness.samples import Place
from harness.spec.actor import ActorOptions
from harness.world.actors.free_space import FreeSpace, from_wall
from harness.world.actors.random_walk import RandomWalk
from harness.world.obstacles import Points

Vector = NDArray[np.float64]

RELAXATION = 0.5  # [s] in which the wanted velocity is taken up
BODY_PUSH, BODY_RANGE = 7.0, 0.3  # [m/s^2] at a gap of 0 (V/sigma = 2.1/0.3), and [m]
WALL_PUSH, WALL_RANGE = 50.0, 0.2  # [m/s^2] at a gap of 0 (U/R = 10/0.2), and [m]
SIGHT = 2.0  # [m] beyond which a gap counts as none
HURRY = 1.3  # times the wanted speed that nobody exceeds
BEHIND = 0.5  # share of a push from behind, outside 100 degrees to either side
FIELD_OF_VIEW = math.cos(math.radians(100.0))
ARRIVED = 0.5  # [m] from a way point
LOOK_AGAIN = 0.5  # [m] from where it was last found out which walls are near
PATIENCE = 20.0  # [s] for a leg beyond what it takes alone, then the next point is headed for


class SocialForceWalker:
    """Goes from way point to way point of a random walk by social forces, a clock tick at a time.

    Args:
        way_points: Where to.
        space: That hazards and the map's edge leave.
        options: Wanted speed, delay and radius of the body.
    """

    def __init__(self, way_points: RandomWalk, space: FreeSpace, options: ActorOptions) -> None:
        self._way_points, self._space = way_points, space
        self._speed, self._delay, self._radius = options.speed, options.delay, options.radius
        self.restart()

    def restart(self) -> None:
        """Puts the walker back to the begin of the walk."""
        self._index, self._place = 0, np.array(self._way_points.point(0))
        self._velocity, self._yaw = np.zeros(2), 0.0
        self._until = -math.inf
        self._walls: list[Vector] = []
        self._looked_at = np.full(2, -math.inf)

    def walk(self, time_s: float, seconds: float, bodies: Sequence[tuple[float, float, float]]) -> Place:
        """Returns where one is, a step after the place returned before.

        Args:
            time_s: At the end of the step [s].
            seconds: Of the step.
            bodies: x, y and radius of the others [m].
        """
        if time_s > self._delay:
            self._step(time_s, seconds, bodies)
        x, y = self._place.tolist()
        return Place(x, y, self._yaw)

    def _step(self, time_s: float, seconds: float, bodies: Sequence[tuple[float, float, float]]) -> None:
        ahead = self._to_next(time_s)
        wanted = ahead * (self._speed / max(math.hypot(*ahead), 1e-9))
        if math.dist(self._place, self._looked_at) > LOOK_AGAIN:
            self._looked_at = self._place
            self._walls = self._space.walls_near(self._place, self._radius + SIGHT + LOOK_AGAIN)
        place, self._velocity = step(
            self._place,
            self._velocity,
            wanted,
            radius=self._radius,
            bodies=bodies,
            walls=self._walls,
            seconds=seconds,
        )
        if not self._is_free(place):
            self._velocity = np.zeros(2)  # pushed against a wall, or to the edge of the map
            return
        self._place = place
        if math.hypot(*self._velocity) > 0.05:
            self._yaw = math.atan2(self._velocity[1], self._velocity[0])

    def _is_free(self, place: Vector) -> bool:
        if self._walls:
            return self._space.blocked(place[None], self._radius) is None
        return bool((place >= self._space.low).all() and (place <= self._space.high).all())

    def _to_next(self, time_s: float) -> Vector:
        """The way to the next way point [m]; to a new one where that is reached, or cannot be."""
        ahead = np.subtract(self._way_points.point(self._index), self._place)
        if math.hypot(*ahead) < ARRIVED or time_s > self._until:
            self._index += 1
            ahead = np.subtract(self._way_points.point(self._index), self._place)
            self._until = time_s + PATIENCE + math.hypot(*ahead) / self._speed
        return np.asarray(ahead)


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
        velocity: In the world, shape (2,) [m/s].
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
