"""The driver that goes to goals: the poses of /goal_pose, by what its lidar sees."""

import math
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation, turning
from harness.drivers.wander import Wander
from harness.samples import Twist

REACHED = 0.25  # [m] from the goal, as Nav2's goal checker
ALIGNED = 0.1  # [rad]


class Goal(Wander):
    """Drives to a goal as `Wander` does to its own, then turns to the goal's heading and stands."""

    summary: ClassVar[str] = "drives to each /goal_pose by its lidar, stands before the first"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._target: tuple[float, float, float] | None = None
        self._is_there = False

    def head_for(self, x: float, y: float, yaw: float) -> None:
        """Takes the next goal; it is there only with that heading."""
        self._target, self._is_there = (x, y, yaw), False
        self._anchor = math.inf, math.inf  # while it stood there it was not stuck

    def command(self, observation: Observation) -> Twist:
        """Returns the twist towards the goal, around what is in the way."""
        if self._target is None:
            return Twist()
        *place, yaw = self._target
        self._is_there |= math.dist(place, (observation.x, observation.y)) < REACHED
        if not self._is_there:
            return super().command(observation)
        error = observation.turn_to(yaw)
        return Twist(0.0, turning(error, self._rover) if abs(error) > ALIGNED else 0.0)

    def _bearing_to_goal(self, observation: Observation) -> float:
        x, y, _ = self._target or (observation.x, observation.y, 0.0)
        return observation.bearing_to(x, y)
