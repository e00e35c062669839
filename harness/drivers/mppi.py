"""Model predictive path integral control (Williams et al. 2017) on a map of what the lidar has seen.

Noise is added to the plan of twists, every noisy plan is driven ahead, and the next plan is their mean,
the cheaper the heavier. Weights are rational, and sums are made in a fixed order: the same bits
everywhere.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.drivers.base import DriverContext, Observation
from harness.drivers.dwa import Dwa, looked_up, turned
from harness.samples import Twist
from harness.world.grid import Lengths

PLANS, STEPS, STEP = 300, 16, 0.15  # noisy plans; twists of a plan and how long each holds [s]
SHARE = 0.9  # of the rover's top speed that is commanded at most
NOISE = 0.35, 0.9  # standard deviation of the noise [m/s], [rad/s]
SMOOTH = 0.6  # how much of its noise a twist of a plan hands on to the next one
CLOSE, CLOSENESS = 0.25, 0.4  # [m] beside the footprint within which each step costs, and how much
TOUCH = 1e3  # of a plan that would touch
TEMPERATURE = 0.35  # [m]: plans that cost so much more than the cheapest weigh a quarter as much


@kernel("f8[:](f8[:,:], f8[:,:], f8[:], f8[:], f8[:,:,:], f8[:], f8)")
def priced(
    clearance: Lengths,
    to_go: Lengths,
    corner: NDArray[np.float64],
    pose: NDArray[np.float64],
    plans: NDArray[np.float64],
    discs: NDArray[np.float64],
    radius: float,
) -> NDArray[np.float64]:
    """Returns the cost of each plan [m].

    Args:
        clearance: As of a LocalMap.
        to_go: As of a LocalMap.
        corner: Of both grids in the world [m].
        pose: x, y [m], cosine and sine of the heading.
        plans: Speeds [m/s] and yaw rates [rad/s], shape (n, STEPS, 2).
        discs: Where discs that cover the footprint lie ahead of the rover's middle [m].
        radius: Of the discs [m].
    """
    costs = np.empty(len(plans))
    for number in range(len(plans)):
        x, y, cos, sin = pose[0], pose[1], pose[2], pose[3]
        cost, left = 0.0, math.inf
        for step in range(STEPS):
            speed, rate = plans[number, step]
            x, y = x + STEP * speed * cos, y + STEP * speed * sin
            cos, sin = turned(cos, sin, STEP * rate)
            room = math.inf
            for disc in discs:
                room = min(room, looked_up(clearance, corner, x + disc * cos, y + disc * sin) - radius)
            left = min(left, looked_up(to_go, corner, x, y))
            cost += CLOSENESS * max(0.0, 1.0 - room / CLOSE) ** 2 + 0.02 * abs(rate) * STEP
            if room <= 0.0:
                cost += TOUCH
                break
        ahead = looked_up(to_go, corner, x + 0.3 * cos, y + 0.3 * sin)
        costs[number] = cost + min(ahead, TOUCH) + 0.2 * min(left, TOUCH)
    return costs


@kernel("f8[:,:](f8[:,:,:], f8[:])")
def blended(plans: NDArray[np.float64], costs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the mean of plans, each with the weight 1 / (1 + its cost above the least / T)^2.

    Args:
        plans: Shape (n, STEPS, 2).
        costs: Of each [m].
    """
    least, total = costs.min(), 0.0
    mean = np.zeros((plans.shape[1], plans.shape[2]))
    for number in range(len(plans)):
        weight = 1.0 / (1.0 + (costs[number] - least) / TEMPERATURE)
        weight *= weight
        weight *= weight
        total += weight
        for step in range(plans.shape[1]):
            for part in range(plans.shape[2]):
                mean[step, part] += weight * plans[number, step, part]
    return mean / total


class Mppi(Dwa):
    """Drives to each goal as a mean of noisy plans says, up to 0.9 of the rover's top speed."""

    summary: ClassVar[str] = "drives to each /goal_pose by path integrals (MPPI) on a local map"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._rng = context.rng
        self._limits = np.array([SHARE * context.rover.top_speed, 2.0 * context.rover.cruise_yaw_rate])
        self._plan = np.zeros((STEPS, 2))

    def _best(self, observation: Observation) -> Twist:
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
