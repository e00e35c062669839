"""Model predictive path integral control (Williams et al. 2017) on a map of what the lidar has seen.

Noise is added to the plan of twists, every noisy plan is driven ahead, and the next plan is their mean,
the cheaper the heavier. Weights are rational, and sums are made in a fixed order: the same bits
everywhere.
"""

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation
from harness.drivers.dwa import Dwa
from harness.samples import Twist

PLANS, STEPS = 300, 16  # noisy plans, and the twists of each
STEP = 0.15  # [s] that each twist of a plan holds
SHARE = 0.9  # of the rover's top speed that is commanded at most
NOISE = 0.35, 0.9  # standard deviation of the noise [m/s], [rad/s]
SMOOTH = 0.6  # how much of its noise a twist of a plan hands on to the next one
NEAR, NEARNESS = 0.25, 0.4  # [m] beside the footprint within which each step costs, and how much
LOOKED_AHEAD = 0.3  # [m] before the end of a plan, where the way to go is looked up: heading counts
TOUCH = 1e3  # of a plan that would touch
TEMPERATURE = 0.35  # [m]: plans that cost so much more than the cheapest weigh a sixteenth as much


class Mppi(Dwa):
    """Drives to each goal as a mean of noisy plans says, up to 0.9 of the rover's top speed."""

    summary: ClassVar[str] = "drives to each /goal_pose by path integrals (MPPI) on a local map"
    # On rough ground it looks down farther off.
    map_options: ClassVar[Mapping[str, float]] = {"marked": 3.0}
    decides_every: ClassVar[int] = 1

    def __init__(self, context: DriverContext) -> None:
        super().__init__(context)
        self._rng = context.rng
        self._limits = np.array([SHARE * context.rover.top_speed, 2.0 * context.rover.cruise_yaw_rate])
        self._plan = np.zeros((STEPS, 2))

    def _best(self, goal: tuple[float, float], observation: Observation) -> Twist:  # noqa: ARG002
        plans = self._noisy()
        outcomes, of = self._rolled(observation, plans, STEP, NEAR, LOOKED_AHEAD), self._rollout
        turned = np.add.reduce(np.abs(plans[:, :, 1]), axis=1)
        cost = NEARNESS * outcomes[:, of.CLOSE] + 0.02 * STEP * turned
        cost += np.minimum(outcomes[:, of.AHEAD], TOUCH) + 0.2 * np.minimum(
            outcomes[:, of.NEAREST], TOUCH
        )
        self._plan = blended(plans, cost + TOUCH * (outcomes[:, of.ROOM] <= 0.0))
        speed, rate = self._plan[0].tolist()
        return Twist(speed, rate)

    def _place_costs(self, here: tuple[int, int]) -> NDArray[np.float64]:  # noqa: ARG002
        return self._map.to_go

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

    def _outlined(self) -> NDArray[np.float64]:
        """Two discs that cover the footprint."""
        x_min, x_max = self.rover.footprint[:2]
        radius = math.hypot(0.25 * self.rover.length, 0.5 * self.rover.width)
        return np.array([(x_min + share * (x_max - x_min), 0.0, radius) for share in (0.25, 0.75)])


def blended(plans: NDArray[np.float64], costs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the mean of plans, each with the weight 1 / (1 + its cost above the least / T)^4.

    Args:
        plans: Shape (n, STEPS, 2).
        costs: Of each [m].
    """
    weights = 1.0 / (1.0 + (costs - costs.min()) / TEMPERATURE)
    weights *= weights
    weights *= weights
    return np.asarray(np.add.reduce(weights[:, None, None] * plans) / math.fsum(weights))
