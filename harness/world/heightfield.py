"""A terrain's surface: heights on a square grid, centred on the world's origin.

Row index runs with +y and column index with +x, the vertices stand at the ends, and each cell is two
triangles split along (row, col)-(row+1, col+1): exactly MuJoCo's heightfield.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Heightfield:
    """Heights in metres, shape (n, n), `cell` metres apart."""

    heights: NDArray[np.float64]
    cell: float

    @property
    def half_size(self) -> float:
        """Half the side length of the map [m]."""
        return 0.5 * self.cell * (len(self.heights) - 1)

    def height_at(self, x: float, y: float) -> float:
        """Height of the surface [m] at a point, which is clamped to the map."""
        n = self.heights.shape[0]
        u = min(max((x + self.half_size) / self.cell, 0.0), n - 1.0)
        v = min(max((y + self.half_size) / self.cell, 0.0), n - 1.0)
        col, row = min(int(u), n - 2), min(int(v), n - 2)
        du, dv = u - col, v - row
        near, far = self.heights[row, col], self.heights[row + 1, col + 1]
        corner = self.heights[row, col + 1] if du >= dv else self.heights[row + 1, col]
        low, high = min(du, dv), max(du, dv)
        return float(near + (corner - near) * (high - low) + (far - near) * low)
