"""How rough the ground is under a wheel: the residual of harness.world.statistics, locally."""

import numpy as np

from harness.world.heightfield import Heightfield
from harness.world.statistics import box_means, reach, residuals

WINDOW = 0.3  # [m]


class RoughnessMap:
    """Mean square residual over WINDOW x WINDOW around each vertex, the residual's window being as wide.

    Obstacles are not in it: it is about the ground. Near the edge of the map, where windows would
    leave it, the nearest value that there is stands.
    """

    def __init__(self, ground: Heightfield) -> None:
        inset = reach(ground, WINDOW)
        squares = box_means(residuals(ground, WINDOW) ** 2, inset)
        self._squares = np.pad(squares, 2 * inset, mode="edge")
        self._half_size, self._vertices_per_metre = ground.half_size, 1.0 / ground.cell

    def mean_square(self, x: float, y: float) -> float:
        """Mean square residual [m^2] at the vertex nearest to a point of the map [m]."""
        row = round((y + self._half_size) * self._vertices_per_metre)
        column = round((x + self._half_size) * self._vertices_per_metre)
        return float(self._squares[row, column])
