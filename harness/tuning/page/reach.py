"""Where on a rover's outline a touch can be told from the range of the touched point."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec

STEP = 1e-3  # [m] along the outline, about


@dataclass(frozen=True, slots=True)
class Reach:
    """Shares of the outline's length; they add up to 1.

    Attributes:
        too_near: Nearer to the lidar than range_min, where no finite range comes from.
        told: Between range_min and the threshold.
        too_far: Not nearer than the threshold: a touch there is no alarm.
    """

    too_near: float
    told: float
    too_far: float


@dataclass(frozen=True, eq=False)
class Side:
    """One side of the outline.

    Attributes:
        points: At even distances from corner to corner [m], shape (n, 2).
        outward: Unit vector away from the rover, shape (2,).
    """

    points: NDArray[np.float64]
    outward: NDArray[np.float64]


def sides(rover: RoverSpec) -> tuple[Side, ...]:
    """All four, in the model frame."""
    x_min, x_max, y_min, y_max = rover.footprint
    corners = np.array([(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)])
    outward = np.array([(0.0, -1.0), (1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
    return tuple(
        Side(_between(start, end), away)
        for start, end, away in zip(corners, np.roll(corners, -1, axis=0), outward, strict=True)
    )


def reach(rover: RoverSpec, range_min: float, threshold: float) -> Reach:
    """What a collision threshold covers of the outline [m]."""
    distance = np.concatenate([_distance(rover, side) for side in sides(rover)])
    far = float(np.mean(distance >= threshold))
    told = float(np.mean((distance >= range_min) & (distance < threshold)))
    return Reach(1.0 - told - far, told, far)


def blind_strips(
    rover: RoverSpec, range_min: float, threshold: float, start: float, width: float
) -> Iterator[NDArray[np.float64]]:
    """Corners, shape (4, 2), of rectangles beside the parts of the outline where a touch is not told.

    Args:
        rover: Whose outline.
        range_min: Of the lidar [m].
        threshold: For collisions [m].
        start: From the outline to the strip [m].
        width: Of the strip [m].
    """
    for side in sides(rover):
        distance = _distance(rover, side)
        blind = (distance < range_min) | (distance >= threshold)
        edges = np.flatnonzero(np.diff(blind, prepend=False, append=False)).reshape(-1, 2)
        for first, after in edges:
            ends = side.points[[first, after - 1]] + side.outward * start
            yield np.concatenate([ends, ends[::-1] + side.outward * width])


def _between(start: NDArray[np.float64], end: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.linspace(start, end, round(float(np.hypot(*(end - start))) / STEP))


def _distance(rover: RoverSpec, side: Side) -> NDArray[np.float64]:
    return np.asarray(np.hypot(side.points[:, 0] - rover.lidar_x, side.points[:, 1]))
