"""One seeded goal after another in a rectangle, as RoboTerrain's collector gives them."""

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from harness.base.errors import UsageError
from harness.samples import Place, Quaternion
from harness.spec.rover import Area
from harness.world.actors.free_space import FreeSpace
from harness.world.heightfield import EDGE_MARGIN
from rover_metrics.core.goals import REACHED, GoalAccount

TRIES = 1000


@dataclass
class GoalCourse:
    """Gives the next goal once the last one is reached or given up."""

    area: Area  # where goals lie
    space: FreeSpace  # keeps them off hazards and on the map
    clearance: float  # to hazards and the map's edge [m]
    rng: np.random.Generator  # source of randomness
    reach: ClassVar[float] = REACHED  # how near a driver has to come to a goal [m]
    _account: GoalAccount = field(default_factory=GoalAccount, init=False)
    _goal: Place = field(init=False)
    _is_given: bool = field(default=False, init=False)

    def __post_init__(self) -> None:
        (x, y), (x_to, y_to) = self.space.low - EDGE_MARGIN, self.space.high + EDGE_MARGIN
        x_min, x_max, y_min, y_max = self.area
        if not (x <= x_min and x_max <= x_to and y <= y_min and y_max <= y_to):
            raise UsageError(
                f"the goal area x {x_min:g} to {x_max:g}, y {y_min:g} to {y_max:g} m reaches beyond the "
                f"map, x {x:g} to {x_to:g}, y {y:g} to {y_to:g} m; give another --goal-area"
            )

    def next(self, time_s: float, place: tuple[float, float], orientation: Quaternion) -> Place | None:
        """Returns the goal that is due at a pose; None while there is one.

        Args:
            time_s: Of the pose [s].
            place: x and y in the world [m].
            orientation: x, y, z, w.

        Raises:
            UsageError: There is no free place in the area.
        """
        self._account.observe(time_s, place, orientation)
        if self._account.goal is None:
            self._goal = self.draw()
            self._account.begin((self._goal.x, self._goal.y), time_s)
        elif self._is_given:
            return None
        self._is_given = True
        return self._goal

    def again(self) -> None:
        """Has `next` give the present goal once more: the driver is new, or was put elsewhere."""
        self._is_given = False

    def draw(self) -> Place:
        """Returns a free place, heading anywhere; UsageError if there is none."""
        x_min, x_max, y_min, y_max = self.area
        low, high = (x_min, y_min, -math.pi), (x_max, y_max, math.pi)
        for x, y, yaw in self.rng.uniform(low, high, size=(TRIES, 3)).tolist():
            if self.space.blocked(np.array([[x, y]]), self.clearance) is None:
                return Place(x, y, yaw)
        raise UsageError(
            f"there is no free place in the goal area x {x_min:g} to {x_max:g}, y {y_min:g} to "
            f"{y_max:g} m; give another --goal-area"
        )
