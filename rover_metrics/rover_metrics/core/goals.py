"""Which goals a rover has reached and which it has given up, by the rule of RoboTerrain's collector."""

import math

from rover_metrics.core.rotation import Quaternion, roll_pitch

REACHED = 0.3  # [m], strictly nearer
PATIENCE_S = 207.0  # [s] for each goal
FLIPPED = 1.48  # [rad] of roll or pitch


class GoalAccount:
    """Counts goals reached and given up; tell it each that is given, then where the rover is.

    The present one, `goal`, is x and y [m]; None before the first and once it is settled.
    """

    def __init__(self) -> None:
        self.reached = self.failed = 0
        self.goal: tuple[float, float] | None = None
        self._since_s = 0.0

    def begin(self, goal: tuple[float, float], time_s: float) -> None:
        """Takes the next goal [m], given at that time; one that is still open counts as neither."""
        self.goal, self._since_s = goal, time_s

    def observe(self, time_s: float, place: tuple[float, float], orientation: Quaternion) -> None:
        """Takes a pose of the rover.

        Args:
            time_s: Of the pose [s].
            place: x, y in the goal's frame [m].
            orientation: Attitude as (x, y, z, w).
        """
        if self.goal is None:
            return
        is_flipped = max(map(abs, roll_pitch(orientation))) > FLIPPED
        if not is_flipped and math.dist(place, self.goal) < REACHED:
            self.reached, self.goal = self.reached + 1, None
        elif is_flipped or time_s - self._since_s > PATIENCE_S:
            self.failed, self.goal = self.failed + 1, None
