"""Model predictive path integral control (Williams et al. 2017) on a map of what the lidar has seen.

Noise is added to the plan of twists, every noisy plan is driven ahead, and the next plan is their mean,
the cheaper the heavier. Weights are rational, and sums are made in a fixed order: the same bits
everywhere.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation
from harness.drivers.dwa import Dwa
from harness.samples import Twist

PLANS, STEPS = 300, 16  # noisy plans, and the twists of each
SHARE = 0.9  # of the rover's top speed that is commanded at most
NOISE = 0.35, 0.9  # standard deviation of the noise [m/s], [rad/s]
SMOOTH = 0.6  # how much of its noise a twist of a plan hands on to the next one


class Mppi(Dwa):
    """Drives to each goal as a mean of noisy plans says, up to 0.9 of the rover's top speed."""

    summary: ClassVar[str] = "drives to each /goal_pose by path integrals (MPPI) on a local map"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._rng = context.rng
        self._limits = np.array([SHARE * context.rover.top_speed, 2.0 * context.rover.cruise_yaw_rate])
        self._plan = np.zeros((STEPS, 2))

    def _best(self, observation: Observation) -> Twist:
        from harness.drivers.mppi_kernel import blended, priced  # noqa: PLC0415 - see Dwa

        yaw = observation.yaw
        pose = np.array([observation.x, observation.y, math.cos(yaw), math.sin(yaw)])
        plans = self._noisy()
        field = self._map.clearance, self._map.to_go, self._corner
        self._plan = blended(plans, priced(*field, pose, plans, self._discs, self._radius))
        speed, rate = self._plan[0].tolist()
        return Twist(speed, rate)

    def _noisy(self) -> NDArray[np.float64]:
        """Plans around the last one; the last one itself and standing still are among them."""
        noise = self._rng.standard_normal((PLANS, STEPS, 2)) * NOISE
        for step in range(1, STEPS):
            noise[:, step] = SMOOTH * noise[:, step - 1] + (1.0 - SMOOTH) * 2.0 * noise[:, step]
        noise[0] = 0.0
        plans = self._plan + noise
        plans[1] = 0.0
        low = np.array([-0.2 * self._limits[0], -self._limits[1]])
        return np.asarray(np.minimum(np.maximum(plans, low), self._limits))
