"""What ROS' base_local_planner knows of places: how far from its path, and which way to turn there.

Lengths are ways along rows and columns of cells (its MapGrid), so a diagonal is as long as its two legs.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.drivers.local_map import CELL, LocalMap
from harness.world.grid import STEPS, Lengths, travel

MOVES = np.array([(0, 1), (1, 0), (0, -1), (-1, 0)], np.int64)
OF_PATH = 0.75  # of a metre beside the path, against a metre of way to its end
MOVED = 0.05  # [m] from where it turned last: it may turn either way again


def place_costs(known: LocalMap, here: tuple[int, int], inscribed: float) -> Lengths:
    """Returns what ending a twist in each cell costs [m]; inf where no way leads.

    Args:
        known: A map that has planned.
        here: Cell of the rover, from which its path begins.
        inscribed: Distance from what is occupied that the rover's middle keeps [m].
    """
    cost = np.where(known.clearance > inscribed, 1.0, np.inf)
    reach = int(inscribed / CELL)
    own = tuple(slice(max(at - reach, 0), at + reach + 1) for at in here)
    cost[own] = 1.0  # it stands there
    path = path_from(known.to_go, here)
    beside, left = (travel(cost, ends, np.zeros(len(ends)), MOVES) for ends in (path, path[-1:]))
    return np.asarray(CELL * (OF_PATH * beside + left))


def path_from(to_go: Lengths, cell: tuple[int, int]) -> NDArray[np.int64]:
    """Returns the cells of the way down from a cell, up to the map's edge, shape (n, 2)."""
    cells = [np.array(cell, np.int64)]
    while True:
        around = np.clip(cells[-1] + STEPS, 0, len(to_go) - 1)
        left = to_go[around[:, 0], around[:, 1]]
        best = int(np.argmin(left))
        if not left[best] < to_go[tuple(cells[-1])]:
            return np.array(cells)
        cells.append(around[best])


class Turns:
    """Oscillation flags: a rover that has turned back on the spot turns on so until it has moved."""

    def __init__(self) -> None:
        self._spot = math.inf, math.inf
        self._done: set[float] = set()
        self._barred = 0.0  # sign of the rates

    def allowed(self, here: tuple[float, float], rates: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Returns which yaw rates [rad/s] may be driven on the spot at a place [m]."""
        if math.dist(here, self._spot) > MOVED:
            self._done, self._barred = set(), 0.0
        return np.asarray(np.sign(rates) * self._barred <= 0.0)

    def take(self, here: tuple[float, float], rate: float) -> None:
        """Takes the yaw rate [rad/s] that is driven on the spot at a place [m]."""
        way = math.copysign(1.0, rate)
        if -way in self._done:
            self._barred = -way
        self._done.add(way)
        self._spot = here
