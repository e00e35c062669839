"""What a ground measures: slopes and roughness; and what a terrain promises of its worlds.

The residual of a vertex is its height above the mean of the square window around it. That is the
distance to the window's best-fit plane at its centre, so a plane of any incline has none. Vertices
whose window would leave the map are left out. Box means and central-difference slopes reproduce the
published figures of the ERC Marsyard 2021 DEM (slope p50 13.0 deg, p95 40.5 deg).
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.world.heightfield import Field, Heightfield

WINDOW = 0.3  # [m]

Range = tuple[float, float]
NONE: Range = (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Promise:
    """Lowest and highest value of each statistic at difficulty 0.5, whatever the seed; 0 by default."""

    slope_p50: Range = NONE  # median slope [deg]; `slope_p95` is the 95th percentile
    slope_p95: Range = NONE
    rms_1m: Range = NONE  # RMS residual over windows of 1 m [m]; `rms_03m` over 0.3 m
    rms_03m: Range = NONE
    obstacle_density: Range = NONE  # rocks and hazards per ground area [1/m2]

    def describe(self) -> str:
        """One line with units."""
        return (
            f"slope p50 {_span(self.slope_p50)} deg, p95 {_span(self.slope_p95)} deg, "
            f"roughness {_span(self.rms_1m, 1e3)} mm over 1 m, {_span(self.rms_03m, 1e3)} mm "
            f"over 0.3 m, {_span(self.obstacle_density, 100)} obstacles per 100 m2"
        )


def slopes(ground: Heightfield) -> Field:
    """Returns the slope at each vertex [deg], by central differences."""
    return np.asarray(np.degrees(np.arctan(steepness(ground.heights, ground.cell))))


def steepness(heights: Field, cell: float) -> Field:
    """Returns the tangent of the slope at each vertex, by central differences."""
    along_y, along_x = np.gradient(heights, cell)
    return np.asarray(np.hypot(along_x, along_y))


def rises(heights: Field) -> Field:
    """Returns the largest difference of each vertex from those next to it along rows and columns."""
    highest = np.zeros_like(heights)
    for field, most in ((heights, highest), (heights.T, highest.T)):
        steps = np.abs(np.diff(field, axis=0))
        most[1:] = np.maximum(most[1:], steps)
        most[:-1] = np.maximum(most[:-1], steps)
    return highest


def averaged(ground: Heightfield, window: float) -> Field:
    """Returns the heights of a ground [m], each the mean of the window [m] around it."""
    inset = reach(ground, window)
    return box_means(np.pad(ground.heights, inset, mode="edge"), inset)


def residuals(ground: Heightfield, window: float) -> Field:
    """Returns the residual [m] of vertices whose window lies in the map: not `reach` at each edge."""
    inset = reach(ground, window)
    inner = slice(inset, -inset)
    return np.asarray(ground.heights[inner, inner] - box_means(ground.heights, inset))


def reach(ground: Heightfield, window: float) -> int:
    """Returns vertices of a window [m] on either side of its middle; one at least, on a coarse map."""
    return max(1, math.floor(window / (2.0 * ground.cell) + 1e-9))


def box_means(heights: Field, reach: int) -> Field:
    """Returns means of all windows within the map, `reach` vertices on either side of their middle."""
    width = 2 * reach + 1
    windows = np.lib.stride_tricks.sliding_window_view
    rows = windows(heights, width, axis=0).mean(axis=-1)
    return np.asarray(windows(rows, width, axis=1).mean(axis=-1))


def _span(values: Range, scale: float = 1.0) -> str:
    low, high = (f"{scale * value:.3g}" for value in values)
    return low if low == high else f"{low}-{high}"


class RoughnessMap:
    """Mean square residual over WINDOW x WINDOW around each vertex, the residual's window being as wide.

    Obstacles are not in it: it is about the ground. Near the edge of the map, where windows would
    leave it, the nearest value that there is stands.

    Attributes:
        squares: The mean square residual at each vertex of the ground [m^2].
    """

    def __init__(self, ground: Heightfield) -> None:
        inset = reach(ground, WINDOW)
        squares = box_means(residuals(ground, WINDOW) ** 2, inset)
        self.squares = np.pad(squares, 2 * inset, mode="edge")
        self._x, _, self._y, _ = ground.bounds()  # of the first vertex
        self._vertices_per_metre = 1.0 / ground.cell

    def mean_square(self, x: float, y: float) -> float:
        """Returns the mean square residual [m^2] at the vertex nearest to a point in the world [m]."""
        rows, columns = self.squares.shape
        row = round((y - self._y) * self._vertices_per_metre)
        column = round((x - self._x) * self._vertices_per_metre)
        # A large rover's wheels leave the map before its origin comes near the edge.
        return float(self.squares[min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)])
