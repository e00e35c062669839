"""Where people are, as RoboTerrain's plugin publishes it: 30 times a second of simulation time.

30 Hz do not divide the clock's 100: of each 10 ticks the 4th, the 7th and the 10th have a sample,
that is each tick by which another thirtieth of a second is full: 40, 30 and 30 ms apart.
"""

import math

from harness.base.sim_time import HIGHEST_RATE
from harness.physics.crowd import Crowd
from harness.physics.simulation import Simulation
from harness.samples import ActorPoses
from harness.sensors.base import Sensor

RATE = 30  # [Hz]


class PeopleSensor(Sensor):
    """Positions and headings of everybody in a crowd."""

    def __init__(self, simulation: Simulation, crowd: Crowd) -> None:
        super().__init__(simulation, HIGHEST_RATE // RATE)
        self._crowd = crowd

    def due(self, tick: int) -> bool:
        """Returns whether a sample falls on a tick, counted from 1."""
        return tick * RATE // HIGHEST_RATE > (tick - 1) * RATE // HIGHEST_RATE

    def read(self) -> ActorPoses:
        """Returns where everybody is."""
        crowd = self._crowd
        halves = [place.yaw / 2 for place in crowd.places]
        turned = tuple((0.0, 0.0, math.sin(half), math.cos(half)) for half in halves)
        return ActorPoses(self._simulation.time_ns, tuple(crowd.positions()), turned)
