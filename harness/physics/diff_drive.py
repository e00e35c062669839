"""cmd_vel -> wheel speeds, as RoboTerrain's Gazebo DiffDrive does it.

The controller limits the acceleration of the commanded twist, latches the last command (Gazebo's has
no timeout) and believes the wheel radius and separation of its own configuration, which for
rover_zero4wd are not those of the model (facts: models/README.md).
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import Twist


class DiffDrive:
    """Controller of a rover that turns by its sides' difference; call `wheel_speeds` once per period."""

    def __init__(self, rover: RoverSpec, period: float) -> None:
        self._rover = rover
        self._on_left = [name in rover.drive.left for name in rover.drive.driven]
        self._linear_step = rover.linear_acceleration * period
        self._angular_step = rover.angular_acceleration * period
        self._target = Twist()
        self._linear = 0.0
        self._angular = 0.0

    def command(self, twist: Twist) -> bool:
        """Latches a command; a non-finite one is refused and the previous one stays."""
        if not (math.isfinite(twist.linear) and math.isfinite(twist.angular)):
            return False
        self._target = twist
        return True

    def wheel_speeds(self) -> NDArray[np.float64]:
        """Returns the speeds of the driven wheels [rad/s], in the order of the rover's `motors`."""
        self._linear = approach(self._linear, self._target.linear, self._linear_step)
        self._angular = approach(self._angular, self._target.angular, self._angular_step)
        half_difference = self._angular * self._rover.controller_separation / 2
        left = (self._linear - half_difference) / self._rover.controller_radius
        right = (self._linear + half_difference) / self._rover.controller_radius
        return np.array([left if on_left else right for on_left in self._on_left])


def approach(value: float, target: float, step: float) -> float:
    """Returns a value that is nearer to a target by at most a step."""
    return value + max(-step, min(step, target - value))
