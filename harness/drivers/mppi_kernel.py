"""The compiled part of path integral control: what noisy plans cost, and their mean."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.drivers.dwa_kernel import looked_up, turned
from harness.drivers.mppi import STEPS
from harness.world.grid import Lengths

STEP = 0.15  # [s] that each twist of a plan holds
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
