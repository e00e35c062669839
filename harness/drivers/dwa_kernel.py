"""The compiled part of the dynamic window approach: what each twist of the window would cost."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.drivers.local_map import CELL, SIDE
from harness.world.grid import Lengths

STEP, STEPS_AHEAD = 0.1, 15  # [s], and how many of them a twist is driven ahead
CLOSE, CLOSENESS = 0.12, 0.5  # [m] beside the footprint within which it costs, and how much [m]


@inlined
def turned(cos: float, sin: float, angle: float) -> tuple[float, float]:
    """A direction turned by a small angle [rad], by a rational rotation: the same bits everywhere."""
    half = angle * (0.5 + angle * angle / 24.0)
    scale = 1.0 / (1.0 + half * half)
    c, s = (1.0 - half * half) * scale, 2.0 * half * scale
    return cos * c - sin * s, sin * c + cos * s


@inlined
def looked_up(field: Lengths, corner: NDArray[np.float64], x: float, y: float) -> float:
    """The value of the cell that a point lies in; inf off the grid."""
    row, column = int((y - corner[1]) / CELL), int((x - corner[0]) / CELL)
    if row < 0 or column < 0 or row >= SIDE or column >= SIDE:
        return math.inf
    return float(field[row, column])


@kernel("f8[:](f8[:,:], f8[:,:], f8[:], f8[:], f8[:,:], f8[:], f8, f8)")
def judged(
    clearance: Lengths,
    to_go: Lengths,
    corner: NDArray[np.float64],
    pose: NDArray[np.float64],
    twists: NDArray[np.float64],
    discs: NDArray[np.float64],
    radius: float,
    ahead: float,
) -> NDArray[np.float64]:
    """Returns the cost of each twist; inf where the footprint would touch.

    Args:
        clearance: As of a LocalMap.
        to_go: As of a LocalMap.
        corner: Of both grids in the world [m].
        pose: x, y [m], cosine and sine of the heading.
        twists: Speed [m/s] and yaw rate [rad/s], shape (n, 2).
        discs: Where discs that cover the footprint lie ahead of the rover's middle [m].
        radius: Of the discs [m].
        ahead: How far before the end the way to the goal is looked up [m].
    """
    costs = np.empty(len(twists))
    for number in range(len(twists)):
        x, y, cos, sin = pose[0], pose[1], pose[2], pose[3]
        speed, rate = twists[number]
        room = math.inf
        for _ in range(STEPS_AHEAD):
            x, y = x + STEP * speed * cos, y + STEP * speed * sin
            cos, sin = turned(cos, sin, STEP * rate)
            for disc in discs:
                room = min(room, looked_up(clearance, corner, x + disc * cos, y + disc * sin) - radius)
        if room <= 0.0:
            costs[number] = math.inf
            continue
        shy = max(0.0, 1.0 - room / CLOSE)
        costs[number] = looked_up(to_go, corner, x + ahead * cos, y + ahead * sin) + CLOSENESS * shy
    return costs
