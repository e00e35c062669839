"""Where people can walk: on the map, and not through hazards. They step over rocks."""

from collections.abc import Sequence

import numpy as np

from harness.world.heightfield import EDGE_MARGIN, Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, Points, outline

CHECKED_EVERY = 0.1  # [m] along a leg


class FreeSpace:
    """The space between hazards that a map leaves to people: x and y from `low` to `high` [m]."""

    def __init__(self, ground: Heightfield, obstacles: Sequence[Obstacle]) -> None:
        x, x_to, y, y_to = ground.bounds(EDGE_MARGIN)
        self.low, self.high = np.array([x, y]), np.array([x_to, y_to])
        hazards = [(n, o) for n, o in enumerate(obstacles) if o.kind is ObstacleKind.HAZARD]
        self._numbers, self._walls = [n for n, _ in hazards], [outline(o) for _, o in hazards]
        corners = [(*wall.min(axis=0), *wall.max(axis=0)) for wall in self._walls]
        self._boxes = np.array(corners).reshape(-1, 4)

    def blocked(self, points: Points, radius: float) -> tuple[str, Points] | None:
        """Returns what blocks a body at one of some points, shape (n, 2), and that point; or None."""
        outside = ~((points >= self.low) & (points <= self.high)).all(axis=1)  # so that NaN is
        if outside.any():
            return "off the map", points[int(outside.argmax())]
        low, high = points.min(axis=0) - radius, points.max(axis=0) + radius
        near = (self._boxes[:, :2] <= high).all(axis=1) & (self._boxes[:, 2:] >= low).all(axis=1)
        for index in np.flatnonzero(near).tolist():
            distance, _ = from_wall(points, self._walls[index])
            if (hit := distance < radius).any():
                return f"through hazard_{self._numbers[index]}", points[int(hit.argmax())]
        return None

    def walls_near(self, point: Points, within: float) -> list[Points]:
        """Returns the outlines of the hazards around a point, closer than some distance [m]."""
        low, high = self._boxes[:, :2] - within, self._boxes[:, 2:] + within
        near = ((low <= point) & (high >= point)).all(axis=1)
        return [self._walls[index] for index in np.flatnonzero(near).tolist()]


def along(points: tuple[tuple[float, float], ...]) -> Points:
    """Returns points on the legs between way points, CHECKED_EVERY metres apart at most."""
    places = np.array(points)
    legs = np.diff(places, axis=0)
    counts = np.maximum(1, np.ceil(np.hypot(*legs.T) / CHECKED_EVERY)).astype(int)
    leg = np.repeat(np.arange(len(legs)), counts)
    step = 1 + np.arange(len(leg)) - np.repeat(np.cumsum(counts) - counts, counts)
    share = (step / counts[leg])[:, None]  # 1 at its end, which is met exactly
    return np.concatenate([places[:1], places[leg] * (1.0 - share) + places[leg + 1] * share])


def from_wall(points: Points, wall: Points) -> tuple[Points, Points]:
    """Returns distances of points (n, 2) from a convex outline (k, 2), and its points nearest to them.

    Distances are negative inside [m]; the corners of the outline go round counter-clockwise.
    """
    edges = np.roll(wall, -1, axis=0) - wall
    squares = np.maximum((edges**2).sum(axis=1), 1e-18)
    offsets = points[:, None] - wall
    share = np.clip((offsets * edges).sum(axis=2) / squares, 0.0, 1.0)
    feet = wall + share[..., None] * edges
    gaps = np.linalg.norm(points[:, None] - feet, axis=2)
    nearest = gaps.argmin(axis=1)
    rows = np.arange(len(points))
    inside = (edges[:, 0] * offsets[..., 1] - edges[:, 1] * offsets[..., 0] >= 0.0).all(axis=1)
    return np.where(inside, -1.0, 1.0) * gaps[rows, nearest], feet[rows, nearest]
