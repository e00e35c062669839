"""The rover's outline seen from above, and how far the returns of a lidar scan are from it.

RoboTerrain measures clearance from the lidar, which sits somewhere on the rover: 0.2 m is a touch
ahead of one rover and lies inside another. Distance from the outline means the same for all of them.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rover_metrics.errors import ParameterError
from rover_metrics.extended.polygon import Point, PolygonDistance, complaint

ROUNDING = 1e-9  # m


@dataclass(frozen=True)
class Footprint:
    """A simple polygon in the base frame, convex or not; corners [m] are in order, either way round."""

    corners: tuple[Point, ...]

    def __post_init__(self) -> None:
        wrong = complaint(self.corners)
        if wrong is not None:
            raise ParameterError(
                f"footprint {wrong}; give the corners of the rover's outline in order, in metres in the "
                "base frame: [x0, y0, x1, y1, x2, y2, ...]"
            )

    @classmethod
    def from_flat(cls, numbers: Sequence[float]) -> "Footprint":
        """Returns the one of x0, y0, x1, y1, ... [m], the form of a ROS parameter."""
        if len(numbers) % 2:
            message = f"footprint has {len(numbers)} numbers, so one corner lacks its y; give pairs"
            raise ParameterError(message)
        values = iter(map(float, numbers))
        return cls(tuple(zip(values, values, strict=True)))

    @classmethod
    def rectangle(cls, bounds: tuple[float, float, float, float]) -> "Footprint":
        """Returns the rectangle from x_min to x_max and from y_min to y_max in the base frame [m]."""
        x_min, x_max, y_min, y_max = bounds
        return cls(((x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max)))


@dataclass(frozen=True)
class LidarPose:
    """Where the lidar's frame is in the base frame: position [m] and heading of its x axis [rad]."""

    x: float = 0.0
    y: float = 0.0
    yaw: float = 0.0

    def __post_init__(self) -> None:
        if not all(map(math.isfinite, (self.x, self.y, self.yaw))):
            raise ParameterError("lidar_pose must be finite numbers: x and y in metres, yaw in radians")

    @classmethod
    def from_flat(cls, numbers: Sequence[float]) -> "LidarPose":
        """Returns the one of x, y, yaw, the form of a ROS parameter."""
        if len(numbers) != 3:
            message = f"lidar_pose has {len(numbers)} numbers; give x and y in metres, yaw in radians"
            raise ParameterError(message)
        return cls(*map(float, numbers))


class FootprintClearance:
    """Distances from the returns of scans to a footprint, for one lidar.

    How far the footprint extends from the lidar in the direction of a beam, its support there, bounds
    how near the beam's return can be to the footprint: range - support at least. One subtraction thus
    finds the most promising beam, which is no farther than the corner of its support; only beams that
    may be nearer than that are measured exactly.

    Args:
        footprint: The outline.
        lidar_pose: Where the lidar is.
        bearings: Azimuth of each beam in the lidar's frame [rad], counter-clockwise, shape (n,).
        near_returns_are_contacts: Whether -inf, something nearer than range_min (REP-117), is
            clearance 0; else it is left out, as a miss is.
    """

    def __init__(
        self,
        footprint: Footprint,
        lidar_pose: LidarPose,
        bearings: ArrayLike,
        *,
        near_returns_are_contacts: bool = False,
    ) -> None:
        azimuths = np.asarray(bearings, dtype=np.float64) + lidar_pose.yaw
        self._directions = np.array((np.cos(azimuths), np.sin(azimuths)))  # shape (2, n)
        self._lidar = np.array(((lidar_pose.x,), (lidar_pose.y,)))
        corners = np.array(footprint.corners).T - self._lidar
        extents = corners.T @ self._directions
        self._support = extents.max(0)
        self._outermost = corners[:, extents.argmax(0)]  # the corner where each beam's support is
        self._distance = PolygonDistance(footprint.corners)
        self._near_returns_are_contacts = near_returns_are_contacts

    def nearest(self, ranges: ArrayLike) -> float:
        """Returns the smallest distance from a finite return to the footprint [m].

        It is 0 if a return is inside and inf if there is none. Ranges are taken as float32, as
        sensor_msgs/LaserScan carries them, one per bearing, coded as REP-117 says.
        """
        values = np.asarray(ranges, dtype=np.float32)
        if values.shape != self._support.shape:
            raise ValueError(f"{values.size} ranges do not fit {self._support.size} bearings")
        if self._near_returns_are_contacts and np.isneginf(values).any():
            return 0.0
        bounds = np.where(np.isfinite(values), values - self._support, np.inf)
        if not bounds.min(initial=np.inf) < np.inf:
            return math.inf
        best = bounds.argmin()
        enough = math.dist(values[best] * self._directions[:, best], self._outermost[:, best])
        rivals = np.flatnonzero(bounds <= max(enough, bounds[best]) + ROUNDING)  # `best` is one of them
        return self._distance(*self._lidar + values[rivals] * self._directions[:, rivals])
