"""The driver that goes to goals without a look: what any other has to be better than."""

import math
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation, turning
from harness.drivers.goal import REACHED
from harness.samples import Sample, Twist


class Beeline:
    """Turns towards its goal while it drives there, slower the more it has to turn.

    A subclass that looks at what is in the way overrides `towards`.
    """

    summary: ClassVar[str] = "drives straight to each /goal_pose, whatever is in the way"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset()

    def __init__(self, context: DriverContext) -> None:
        self.rover = context.rover
        self._goal: tuple[float, float] | None = None

    def head_for(self, x: float, y: float, _yaw: float) -> None:
        """Takes the next goal [m]; it arrives there with any heading."""
        self._goal = x, y

    def command(self, observation: Observation) -> Twist:
        """Returns the twist towards the goal; zero at the goal, and before the first one."""
        here = observation.x, observation.y
        if self._goal is None or math.dist(self._goal, here) < REACHED:
            return Twist()
        return self.towards(self._goal, observation)

    def towards(self, goal: tuple[float, float], observation: Observation) -> Twist:
        """Returns the twist towards a goal that is not reached [m]."""
        error = observation.bearing_to(*goal)
        return Twist(self.rover.cruise_speed * max(0.0, math.cos(error)), turning(error, self.rover))
