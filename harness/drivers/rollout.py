"""The compiled part of drivers that drive plans ahead: where each plan leads on a map."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.drivers.local_map import CELL, SIDE
from harness.world.grid import Lengths

# What `rolled` returns of each plan.
ROOM, CLOSE, END, AHEAD, NEAREST, FARTHEST = range(6)


@inlined
def turned(cos: float, sin: float, angle: float) -> tuple[float, float]:
    """Returns a direction turned by a small angle, by a rational rotation: the same bits everywhere.

    Args:
        cos: Of the direction.
        sin: Of the direction.
        angle: Counter-clockwise [rad].
    """
    half = angle * (0.5 + angle * angle / 24.0)
    scale = 1.0 / (1.0 + half * half)
    c, s = (1.0 - half * half) * scale, 2.0 * half * scale
    return cos * c - sin * s, sin * c + cos * s


@inlined
def _looked_up(field: Lengths, x: float, y: float) -> float:
    """The value of the cell that a point of the grid lies in [m]; inf off the grid."""
    row, column = int(y / CELL), int(x / CELL)
    if row < 0 or column < 0 or row >= SIDE or column >= SIDE:
        return math.inf
    return float(field[row, column])


@kernel("f8[:,:](f8[:,:], f8[:,:], f8[:], f8[:,:,:], f8, f8[:,:], f8, f8)")
def rolled(
    clearance: Lengths,
    to_go: Lengths,
    pose: NDArray[np.float64],
    plans: NDArray[np.float64],
    step: float,
    outline: NDArray[np.float64],
    close: float,
    ahead: float,
) -> NDArray[np.float64]:
    """Drives plans ahead and returns what is found of each, shape (n, 6).

    ROOM is the least distance of the outline from what is occupied [m]; CLOSE the sum over the steps of
    (1 - distance / close)^2 where it is less than `close`; END the way to go from the last place, AHEAD
    that from a place ahead of it, NEAREST the least and FARTHEST the largest of all steps [m]. A plan
    ends where it touches.

    Args:
        clearance: As of a LocalMap.
        to_go: As of a LocalMap.
        pose: x, y from the corner of both grids [m], cosine and sine of the heading.
        plans: Speeds [m/s] and yaw rates [rad/s], shape (n, steps, 2).
        step: How long each of them holds [s].
        outline: Points of the rover ahead and to the left of its middle, with the radius of the disc
            around each [m], shape (m, 3).
        close: Distance within which places are close [m].
        ahead: How far ahead of the last place AHEAD is [m].
    """
    result = np.zeros((len(plans), 6))
    for number in range(len(plans)):
        x, y, cos, sin = pose[0], pose[1], pose[2], pose[3]
        least, sum_close, end, nearest, farthest = math.inf, 0.0, math.inf, math.inf, 0.0
        for index in range(plans.shape[1]):
            speed, rate = plans[number, index]
            x, y = x + step * speed * cos, y + step * speed * sin
            cos, sin = turned(cos, sin, step * rate)
            room = math.inf
            for at_x, at_y, radius in outline:
                place_x, place_y = x + at_x * cos - at_y * sin, y + at_x * sin + at_y * cos
                room = min(room, _looked_up(clearance, place_x, place_y) - radius)
            least, end = min(least, room), _looked_up(to_go, x, y)
            nearest, farthest = min(nearest, end), max(farthest, end)
            sum_close += max(0.0, 1.0 - room / close) ** 2
            if room <= 0.0:
                break
        result[number, ROOM], result[number, CLOSE] = least, sum_close
        result[number, END], result[number, NEAREST], result[number, FARTHEST] = end, nearest, farthest
        result[number, AHEAD] = _looked_up(to_go, x + ahead * cos, y + ahead * sin)
    return result
