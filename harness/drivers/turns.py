"""Which way a rover may still turn on the spot: the oscillation flags of ROS' base_local_planner."""

import math

import numpy as np
from numpy.typing import NDArray

MOVED = 0.05  # [m] from where it turned last: it may turn either way again


class Turns:
    """Remembers turns on a spot; who has turned back may only turn on that way until he has moved."""

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
