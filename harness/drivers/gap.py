"""A reactive driver: follows the gap in one scan that leads nearest to its goal, without memory.

After the follow-the-gap method (Sezer and Gokasan 2012): obstacles are widened by the rover's half
width, what is left between them are gaps.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation, aside, turning
from harness.drivers.beeline import Beeline
from harness.samples import LaserScan, Sample, Twist

MARGIN = 0.08  # [m] beside the rover
FAR = 3.0  # [m]: a direction that is free so far is open
SECTORS = 180  # directions that are looked at, all around
STOP = 0.08  # [m] of room ahead at which it stops
SHARE = 0.8  # of the rover's top speed that it drives at most
HEADWAY = 1.2  # [s]: time for which it has room at its speed
QUICKER = 1.5  # times the yaw rate of `turning`


class Gap(Beeline):
    """Turns to the direction whose room and whose detour are best, as one scan shows them."""

    summary: ClassVar[str] = "drives to each /goal_pose through the gaps of one scan, without memory"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        rover, self._bearings = context.rover, context.bearings
        self._directions = np.linspace(-math.pi, math.pi, SECTORS + 1)[:-1]
        self._width = 0.5 * rover.width + MARGIN
        self._nose = rover.footprint[1] - rover.lidar_x

    def towards(self, goal: tuple[float, float], observation: Observation) -> Twist:
        """Returns the twist into the gap that leads to a goal best."""
        room = self._room(observation.ranges, math.dist(goal, (observation.x, observation.y)))
        heading = self._heading(room, observation.bearing_to(*goal))
        ahead = max(0.0, float(room[SECTORS // 2]) - self._nose - STOP)
        speed = min(SHARE * self.rover.top_speed, ahead / HEADWAY)
        return Twist(speed * max(0.0, math.cos(heading)) ** 2, QUICKER * turning(heading, self.rover))

    def _heading(self, room: NDArray[np.float64], error: float) -> float:
        """The direction whose detour is least among those that are open, or the one with most room."""
        cost = aside(self._directions - error) + 2.0 * (FAR - room) + 0.2 * np.abs(self._directions)
        return float(self._directions[int(np.argmin(cost))])

    def _room(self, ranges: NDArray[np.float32] | None, most: float) -> NDArray[np.float64]:
        """How far each direction is free for the rover's width [m], at most FAR."""
        free = np.full(SECTORS, FAR)
        if ranges is None:
            return free
        near = np.flatnonzero((ranges > 0.0) & (ranges < FAR))
        distance = ranges[near].astype(np.float64)
        off = aside(self._directions[:, None] - self._bearings[near][None, :])
        across, along = distance * np.sin(off), distance * np.cos(off)
        blocks = (across < self._width) & (along > 0.0)
        free = np.where(blocks, along, FAR).min(axis=1, initial=FAR)
        return np.where(free >= min(most, FAR), FAR, free)
