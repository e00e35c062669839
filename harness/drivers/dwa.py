"""The dynamic window approach (Fox, Burgard and Thrun 1997) on a map of what the lidar has seen.

Every twist of a window is driven ahead for a while; the one whose end has the cheapest way to the goal
wins, if the footprint stays free. Its limits are those that BARN's DWA was published with.
"""

import math
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.drivers.base import DriverContext, Observation
from harness.drivers.goal import REACHED
from harness.drivers.local_map import CELL, SIDE, LocalMap
from harness.samples import LaserScan, Sample, Twist
from harness.world.grid import Lengths

TOP_SPEED, TOP_RATE = 0.5, 1.57  # [m/s], [rad/s]: DWA as the BARN challenge ships it
SPEEDS, RATES = 6, 21  # twists of the window
WINDOW = 1.0, 3.0  # [m/s], [rad/s]: how far the next twist may be from the last one
STEP, STEPS_AHEAD = 0.1, 15  # [s], and how many of them a twist is driven ahead
# [m] before the end, where the way to the goal is looked up: heading counts; less near the goal
AHEAD, AHEAD_SHARE = 0.25, 0.4
CLOSE, CLOSENESS = 0.12, 0.5  # [m] beside the footprint within which it costs, and how much [m]
PLANNED_EVERY = 4  # periods
BACK = -0.15  # [m/s], if every twist would touch


@inlined
def turned(cos: float, sin: float, angle: float) -> tuple[float, float]:
    """A direction turned by a small angle [rad], by a rational rotation: the same bits everywhere."""
    half = angle * (0.5 + angle * angle / 24.0)
    scale = 1.0 / (1.0 + half * half)
    c, s = (1.0 - half * half) * scale, 2.0 * half * scale
    return cos * c - sin * s, sin * c + cos * s


@inlined
def looked_up(field: Lengths, corner: NDArray[np.float64], x: float, y: float) -> float:
    """The value of the cell that a point lies in; inf off the grid."""
    row, column = int((y - corner[1]) / CELL), int((x - corner[0]) / CELL)
    if row < 0 or column < 0 or row >= SIDE or column >= SIDE:
        return math.inf
    return float(field[row, column])


@kernel("f8[:](f8[:,:], f8[:,:], f8[:], f8[:], f8[:,:], f8[:], f8, f8)")
def judged(
    clearance: Lengths,
    to_go: Lengths,
    corner: NDArray[np.float64],
    pose: NDArray[np.float64],
    twists: NDArray[np.float64],
    discs: NDArray[np.float64],
    radius: float,
    ahead: float,
) -> NDArray[np.float64]:
    """Returns the cost of each twist; inf where the footprint would touch.

    Args:
        clearance: As of a LocalMap.
        to_go: As of a LocalMap.
        corner: Of both grids in the world [m].
        pose: x, y [m], cosine and sine of the heading.
        twists: Speed [m/s] and yaw rate [rad/s], shape (n, 2).
        discs: Where discs that cover the footprint lie ahead of the rover's middle [m].
        radius: Of the discs [m].
        ahead: How far before the end the way to the goal is looked up [m].
    """
    costs = np.empty(len(twists))
    for number in range(len(twists)):
        x, y, cos, sin = pose[0], pose[1], pose[2], pose[3]
        speed, rate = twists[number]
        room = math.inf
        for _ in range(STEPS_AHEAD):
            x, y = x + STEP * speed * cos, y + STEP * speed * sin
            cos, sin = turned(cos, sin, STEP * rate)
            for disc in discs:
                room = min(room, looked_up(clearance, corner, x + disc * cos, y + disc * sin) - radius)
        if room <= 0.0:
            costs[number] = math.inf
            continue
        shy = max(0.0, 1.0 - room / CLOSE)
        costs[number] = looked_up(to_go, corner, x + ahead * cos, y + ahead * sin) + CLOSENESS * shy
    return costs


class Dwa:
    """Drives to each goal by the twist that leads on best."""

    summary: ClassVar[str] = "drives to each /goal_pose by the dynamic window approach on a local map"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
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
