"""The driver that goes to goals without a look: what any other has to be better than."""

import math
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation
from harness.drivers.goal import REACHED
from harness.samples import Sample, Twist

TURN_GAIN = 2.0  # of the cruising yaw rate for each radian


class Beeline:
    """Turns towards its goal while it drives there, slower the more it has to turn."""

    summary: ClassVar[str] = "drives straight to each /goal_pose, whatever is in the way"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset()

    def __init__(self, context: DriverContext) -> None:
        self._rover = context.rover
        self._goal: tuple[float, float] | None = None

    def head_for(self, x: float, y: float, _yaw: float) -> None:
        """Takes the next goal [m]; it arrives there with any heading."""
        self._goal = x, y

    def command(self, observation: Observation) -> Twist:
        """Returns the twist towards the goal; it stands there, and before the first."""
        here = observation.x, observation.y
        if self._goal is None or math.dist(self._goal, here) < REACHED:
            return Twist()
        bearing = math.atan2(self._goal[1] - here[1], self._goal[0] - here[0])
        error = math.remainder(bearing - observation.yaw, math.tau)
        rate = max(-1.0, min(1.0, TURN_GAIN * error)) * self._rover.cruise_yaw_rate
        return Twist(self._rover.cruise_speed * max(0.0, math.cos(error)), rate)
