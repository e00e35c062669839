"""One who strolls, but keeps out of the way of the rover, of others and of walls."""

import math
from collections.abc import Sequence

import numpy as np

from harness.samples import Place
from harness.world.actors.room import Room
from harness.world.actors.social_force import SIGHT, Vector, step
from harness.world.actors.stroll import Stroll

ARRIVED = 0.5  # [m] from a way point
LOOK_AGAIN = 0.5  # [m] from where it was last found out which walls are near
PATIENCE = 20.0  # [s] for a leg beyond what it takes alone, then the next point is headed for


class SocialWalker:
    """Goes from way point to way point of a stroll by social forces, a clock tick at a time."""

    def __init__(self, stroll: Stroll, room: Room, *, speed: float, delay: float, radius: float) -> None:
        self._stroll, self._room = stroll, room
        self._speed, self._delay, self._radius = speed, delay, radius
        self.restart()

    def restart(self) -> None:
        """Puts the walker back to the begin of the walk."""
        self._spot, self._place = 0, np.array(self._stroll.spot(0))
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
        way = self._way(time_s)
        wanted = way * (self._speed / max(math.hypot(*way), 1e-9))
        if math.dist(self._place, self._looked_at) > LOOK_AGAIN:
            self._looked_at = self._place
            self._walls = self._room.walls_near(self._place, self._radius + SIGHT + LOOK_AGAIN)
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
            return self._room.trouble(place[None], self._radius) is None
        return bool((place >= self._room.low).all() and (place <= self._room.high).all())

    def _way(self, time_s: float) -> Vector:
        """To the next way point [m]; a new one where that is reached, or cannot be."""
        way = np.subtract(self._stroll.spot(self._spot), self._place)
        if math.hypot(*way) < ARRIVED or time_s > self._until:
            self._spot += 1
            way = np.subtract(self._stroll.spot(self._spot), self._place)
            self._until = time_s + PATIENCE + math.hypot(*way) / self._speed
        return np.asarray(way)
