"""The way points of a route as goals, one after another."""

import math
from dataclasses import dataclass, field

from harness.samples import Place, Quaternion
from harness.world.route import Mark, RouteProgress
from harness.world.targets.placing import Where

STAND_OFF = 0.7  # of the radius, before what stands at a way point
SPARE = 0.3  # [m] of the radius at least, behind the goal before it: drivers stop 0.25 m short
BEYOND = 1.0  # [m] behind a gate, so that a driver which stops before its goal has passed it


@dataclass
class RouteCourse:
    """Gives the next way point once the last one is reached or missed; used as a GoalCourse is."""

    progress: RouteProgress
    _given: int | None = field(default=None, init=False)
    _yaw: float = field(default=0.0, init=False)  # of the goal that was given [rad]

    @property
    def reach(self) -> float:
        """How near a driver has to come to each of its goals [m]; gates are passed, however near."""
        marks = (mark for mark in self.progress.marks if mark.gate is None)
        return min((mark.radius - _stand_off(mark) for mark in marks), default=math.inf)

    def next(self, time_s: float, place: Where, orientation: Quaternion) -> Place | None:  # noqa: ARG002
        """Returns the goal that is due at a pose; None while it stays.

        Who came round a gate and stands behind it without having passed is sent back through it.

        Args:
            time_s: Of the pose [s].
            place: x and y in the world [m].
            orientation: x, y, z, w.
        """
        self.progress.observe(time_s, place)
        current = self.progress.current
        if current is None:
            return None
        mark = self.progress.marks[current]
        is_given = current == self._given
        if is_given and (mark.gate is None or not self.progress.stands):
            return None
        goal = _goal(mark, place)
        if is_given and math.cos(goal.yaw - self._yaw) > 0.0:
            return None
        self._given, self._yaw = current, goal.yaw
        return goal

    def again(self) -> None:
        """Has `next` give the present goal once more: the driver is new, or was put elsewhere."""
        self._given = None
        self.progress.carried_away()


def _goal(mark: Mark, place: Where) -> Place:
    """Returns where to go for a way point from a place [m]: through a gate, else up to it."""
    (x, y), yaw = mark.place, math.atan2(mark.place[1] - place[1], mark.place[0] - place[0])
    if mark.gate is not None:
        (left_x, left_y), (right_x, right_y) = mark.gate
        across = math.atan2(right_x - left_x, left_y - right_y)  # either way through
        yaw = across if math.cos(across - yaw) > 0.0 else across + math.pi
        x, y = x + BEYOND * math.cos(yaw), y + BEYOND * math.sin(yaw)
    else:
        x -= _stand_off(mark) * math.cos(yaw)
        y -= _stand_off(mark) * math.sin(yaw)
    return Place(x, y, math.remainder(yaw, math.tau))


def _stand_off(mark: Mark) -> float:
    """How far before a way point the goal is [m]: where something stands, nobody can be."""
    return min(STAND_OFF * mark.radius, max(0.0, mark.radius - SPARE)) if mark.is_solid else 0.0
