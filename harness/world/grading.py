"""A world graded for a rover: how steep, stepped and rough each cell is, and how near its limits.

Unlike harness.world.occupancy it does not mark the map's edge, where a run ends.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Field, Heightfield
from harness.world.obstacles import HEADROOM, ObstacleKind, bottom, top
from harness.world.occupancy import RESOLUTION, covered, middles
from harness.world.statistics import WINDOW, RoughnessMap, averaged, rises, steepness
from harness.world.world import World

Cells = NDArray[np.float64]
LAYERS = ("elevation", "slope", "step", "roughness", "tip_margin", "danger")


@dataclass(frozen=True)
class Limits:
    """What a rover can do."""

    slope: float  # steepest slope that it climbs [rad]
    step: float  # highest step that it climbs [m]
    tip: float  # tilt at which it tips over [rad]
    span: float  # over which it stands [m]


@dataclass(frozen=True, eq=False)
class GradedMap:
    """Cells in rows with +y and columns with +x, shape (rows, columns) each."""

    # by LAYERS: elevation of what is met first from above [m]; slope of the ground over 0.3 m
    # [rad]; step to a neighbour beyond the steepest slope, or onto an obstacle [m]; roughness, RMS
    # over 0.3 m [m]; tip_margin, the tilt at which the rover tips less that of the ground over its
    # length [rad]; danger, the largest share of its limit that slope, step or tilt takes, 1 where
    # a hazard stands: from 1 on the rover cannot go there
    layers: dict[str, Cells]
    resolution: float  # side length of a cell [m]
    corner: tuple[float, float]  # x, y of the first cell's outer corner in the world [m]

    def danger_at(self, x: Cells, y: Cells) -> Cells:
        """Returns the danger at points in the world [m]; NaN off the map."""
        danger = self.layers["danger"]
        columns = np.floor((x - self.corner[0]) / self.resolution).astype(int)
        rows = np.floor((y - self.corner[1]) / self.resolution).astype(int)
        is_on = (rows >= 0) & (rows < danger.shape[0]) & (columns >= 0) & (columns < danger.shape[1])
        return np.where(is_on, danger[rows * is_on, columns * is_on], np.nan)


def graded(world: World, limits: Limits) -> GradedMap:
    """Returns the grades of a world for a rover with these limits."""
    ground = world.ground
    at = [middles(half, RESOLUTION) for half in ground.half_size]
    places = tuple(along + middle for along, middle in zip(at, ground.middle, strict=True))
    x, y = np.meshgrid(*places)
    slope = _sampled(_slope(ground, WINDOW), ground, x, y)
    beyond_slope = rises(ground.heights) - ground.cell * math.tan(limits.slope)
    step = _sampled(np.maximum(beyond_slope, 0.0), ground, x, y)
    tilt = _sampled(_slope(ground, limits.span), ground, x, y)
    roughness = _sampled(np.sqrt(RoughnessMap(ground).squares), ground, x, y)
    elevation, hazard = ground.heights_at(x, y), np.zeros(x.shape, bool)
    for obstacle in world.obstacles:
        level = ground.height_at(*obstacle.position[:2])
        if bottom(obstacle) - level <= HEADROOM:
            (window, cells), height = covered(obstacle, places, RESOLUTION), top(obstacle)
            _raise(elevation, window, cells, height)
            if obstacle.kind is not ObstacleKind.DECK:
                _raise(step, window, cells, height - level)
            hazard[window] |= cells & (obstacle.kind is ObstacleKind.HAZARD)
    shares = [slope / limits.slope, step / limits.step, tilt / limits.tip]
    danger = np.maximum(np.max(shares, axis=0), hazard)
    values = (elevation, slope, step, roughness, limits.tip - tilt, danger)
    corner = (ground.middle[0] - ground.half_size[0], ground.middle[1] - ground.half_size[1])
    return GradedMap(dict(zip(LAYERS, values, strict=True)), RESOLUTION, corner)


def _raise(layer: Cells, window: Any, cells: NDArray[np.bool_], least: float) -> None:  # noqa: ANN401
    """Lifts cells of a window of a layer to a value."""
    layer[window] = np.where(cells, np.maximum(layer[window], least), layer[window])


def _slope(ground: Heightfield, window: float) -> Field:
    """The slope at each vertex of the ground averaged over a window [rad]."""
    return np.asarray(np.arctan(steepness(averaged(ground, window), ground.cell)))


def _sampled(vertices: Field, ground: Heightfield, x: Cells, y: Cells) -> Cells:
    """The value of the nearest vertex."""
    left, _, low, _ = ground.bounds()
    rows, columns = vertices.shape
    row = np.rint((y - low) / ground.cell).astype(int).clip(0, rows - 1)
    column = np.rint((x - left) / ground.cell).astype(int).clip(0, columns - 1)
    return np.asarray(vertices[row, column], dtype=float)
