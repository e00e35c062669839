"""A stand-in for the RL agents that drove when RoboTerrain's logs were recorded.

It finds its way like the default driver, but at a speed that it chooses anew every few seconds: mostly
slow, sometimes up to 1 m/s, as the recorded velocities are spread. It commands over cmd_vel, one
control period late, as an agent behind a topic does.
"""

import math
from dataclasses import replace

import numpy as np

from harness.drivers import DriverContext, Observation
from harness.drivers.wander import Wander
from harness.samples import Twist

# Quantiles of Current Velocity in the logs of 2025-01-16 [m/s], evenly spaced from 0 to 1; the slow
# end is left to obstacles and turns.
SPEEDS = (0.15, 0.24, 0.28, 0.32, 0.36, 0.42, 0.55, 0.78, 1.0)
SPEED_HELD = (6.0, 14.0)  # [s]: recorded velocities are alike for some ten seconds
TURN_RATE = 2.0  # [rad/s]


class RecordedAgent:
    """Chooses commands from observations; seeded."""

    def __init__(self, context: DriverContext) -> None:
        self._rng = context.rng
        unit = replace(context.rover, cruise_speed=1.0, cruise_yaw_rate=TURN_RATE)
        self._wander = Wander(replace(context, rover=unit))
        self._speed, self._until_ns = 0.0, 0

    def command(self, observation: Observation) -> Twist:
        """The default driver's command at the speed of the moment."""
        if observation.time_ns >= self._until_ns:
            held = self._rng.uniform(*SPEED_HELD)
            self._until_ns = observation.time_ns + math.floor(held * 1e9)
            place = self._rng.uniform(0, len(SPEEDS) - 1)
            self._speed = float(np.interp(place, range(len(SPEEDS)), SPEEDS))
        twist = self._wander.command(observation)
        return Twist(twist.linear * self._speed, twist.angular)
