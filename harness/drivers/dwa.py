"""The dynamic window approach (Fox, Burgard and Thrun 1997) on a map of what the lidar has seen.

Every twist of a window is driven ahead for a while; the one whose end has the cheapest way to the goal
wins, if the footprint stays free. Its limits are those that BARN's DWA was published with.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation
from harness.drivers.goal import REACHED
from harness.samples import LaserScan, Sample, Twist

TOP_SPEED, TOP_RATE = 0.5, 1.57  # [m/s], [rad/s]: DWA as the BARN challenge ships it
SPEEDS, RATES = 6, 21  # twists of the window
WINDOW = 1.0, 3.0  # [m/s], [rad/s]: how far the next twist may be from the last one
# [m] before the end, where the way to the goal is looked up: heading counts; less near the goal
AHEAD, AHEAD_SHARE = 0.25, 0.4
PLANNED_EVERY = 4  # periods
BACK = -0.15  # [m/s], if every twist would touch


class Dwa:
    """Drives to each goal by the twist that leads on best."""

    summary: ClassVar[str] = "drives to each /goal_pose by the dynamic window approach on a local map"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
        from harness.drivers.local_map import LocalMap  # noqa: PLC0415 - who only names drivers does

        rover = context.rover
        self._map = LocalMap(context)
        self._top = min(TOP_SPEED, rover.top_speed), TOP_RATE
        x_min, x_max = rover.footprint[:2]
        self._discs = np.array([x_min + share * (x_max - x_min) for share in (0.25, 0.75)])
        self._radius = math.hypot(0.25 * rover.length, 0.5 * rover.width)
        self._goal: tuple[float, float] | None = None
        self._last, self._count = Twist(), 0

    def head_for(self, x: float, y: float, _yaw: float) -> None:
        """Takes the next goal [m]; it arrives there with any heading."""
        self._goal, self._count = (x, y), 0

    def command(self, observation: Observation) -> Twist:
        """Returns the twist that leads on best; it stands at the goal, and before the first."""
        here = observation.x, observation.y
        self._map.see(observation)
        if self._goal is None or math.dist(self._goal, here) < REACHED:
            self._last = Twist()
            return self._last
        if self._count % PLANNED_EVERY == 0:
            self._map.plan(here, self._goal)
            self._corner = np.array(self._map.corner)
        self._count += 1
        self._last = self._best(observation)
        return self._last

    def _best(self, observation: Observation) -> Twist:
        from harness.drivers.dwa_kernel import judged  # noqa: PLC0415 - without compiled kernels

        twists, yaw = self._window(), observation.yaw
        pose = np.array([observation.x, observation.y, math.cos(yaw), math.sin(yaw)])
        field = self._map.clearance, self._map.to_go, self._corner
        assert self._goal is not None  # noqa: S101 - as `command` makes sure
        ahead = min(AHEAD, AHEAD_SHARE * math.dist(self._goal, (observation.x, observation.y)))
        costs = judged(*field, pose, twists, self._discs, self._radius, ahead)
        best = int(np.argmin(costs))
        if not math.isfinite(costs[best]):
            return Twist(BACK)
        return Twist(float(twists[best, 0]), float(twists[best, 1]))

    def _window(self) -> NDArray[np.float64]:
        top, rate = self._top
        dv, dw = WINDOW
        speeds = np.linspace(max(0.0, self._last.linear - dv), min(top, self._last.linear + dv), SPEEDS)
        rates = np.linspace(
            max(-rate, self._last.angular - dw), min(rate, self._last.angular + dw), RATES
        )
        return np.column_stack([np.repeat(speeds, RATES), np.tile(rates, SPEEDS)])
