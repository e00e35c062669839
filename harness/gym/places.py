"""Where on a map a rover can stand, and what it can reach from there."""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.gym.options import Range
from harness.robots import RoverSpec
from harness.world.occupancy import FREE, occupancy
from harness.world.world import World

RESOLUTION = 0.2  # [m] of the cells that places are drawn from
FEW = 100  # places that are tried
MARGIN = 0.15  # [m] of free ground around the rover, whichever way it looks

Point = tuple[float, float]


class Places:
    """The largest part of a map that a rover can reach from each of its places, as cells.

    Attributes:
        middles: Of its cells in the world [m], shape (k, 2).
        middle: Of the map in the world [m].
    """

    def __init__(self, world: World, rover: RoverSpec) -> None:
        from scipy.ndimage import distance_transform_edt, label  # noqa: PLC0415 - slow to import

        cells = occupancy(world, rover.slope_limit, rover.step_limit, RESOLUTION)
        reach = max(math.hypot(x, y) for x in rover.footprint[:2] for y in rover.footprint[2:])
        clearance = RESOLUTION * distance_transform_edt(cells.cells == FREE)
        parts, _ = label(clearance > reach + MARGIN)
        sizes = np.bincount(parts.ravel())
        sizes[0] = 0
        if not sizes.any():
            raise UsageError(f"{rover.name} can stand nowhere on {world.name}; choose an easier world")
        rows, columns = np.nonzero(parts == sizes.argmax())
        self.middle = np.array(cells.middle)
        corner = self.middle - cells.half_size
        self.middles: NDArray[np.float64] = (
            np.column_stack([columns, rows]) + 0.5
        ) * RESOLUTION + corner

    def draw(
        self, rng: np.random.Generator, around: Point, distance: Range, box: float = math.inf
    ) -> Point:
        """Returns a place [m], evenly distributed, as wanted to half a cell; else the nearest to that.

        Args:
            rng: Source of randomness.
            around: Point in the world [m].
            distance: From that point, at least and at most [m].
            box: Largest distance from the map's middle along x and along y [m].
        """
        middle_x, middle_y = self.middle.tolist()
        for _ in range(FEW):  # mostly enough, and cheaper than to look at all
            x, y = self._jittered(self.middles[rng.integers(len(self.middles))], rng)
            away = math.dist(around, (x, y))
            if distance[0] <= away <= distance[1] and max(abs(x - middle_x), abs(y - middle_y)) <= box:
                return x, y
        away_from = np.hypot(*(self.middles - around).T)
        missed = np.maximum(distance[0] - away_from, away_from - distance[1])
        missed = np.maximum(missed, np.abs(self.middles - self.middle).max(axis=1) - box).clip(min=0.0)
        nearest = self.middles[missed == missed.min()]
        return self._jittered(nearest[rng.integers(len(nearest))], rng)

    def _jittered(self, middle: NDArray[np.float64], rng: np.random.Generator) -> Point:
        """A point of a cell, as it can be typed after --start."""
        x, y = (middle + rng.uniform(-0.5, 0.5, 2) * RESOLUTION).tolist()
        return round(x, 3), round(y, 3)
