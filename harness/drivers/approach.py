"""Straight lines past obstacles: geometry for drivers that meet them on purpose."""

import math
from dataclasses import dataclass

from harness.world.obstacles import Obstacle

Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Line:
    """A directed line in the plane.

    Attributes:
        through: A point of it [m].
        heading: Its direction [rad].
    """

    through: Point
    heading: float

    def along(self, point: Point) -> float:
        """How far ahead of `through` a point lies [m]."""
        dx, dy = point[0] - self.through[0], point[1] - self.through[1]
        return dx * math.cos(self.heading) + dy * math.sin(self.heading)

    def aside(self, point: Point) -> float:
        """How far to the left of the line a point lies [m]."""
        dx, dy = point[0] - self.through[0], point[1] - self.through[1]
        return dy * math.cos(self.heading) - dx * math.sin(self.heading)

    def at(self, distance: float) -> Point:
        """The point so far ahead of `through` [m]."""
        x, y = self.through
        return x + distance * math.cos(self.heading), y + distance * math.sin(self.heading)


def line_past(obstacle: Obstacle, heading: float, aside: float) -> Line:
    """The line of that heading [rad] whose foot lies `aside` metres to the left of an obstacle."""
    x, y, _ = obstacle.position
    return Line((x - aside * math.sin(heading), y + aside * math.cos(heading)), heading)
