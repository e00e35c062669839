"""The default driver: seeks seeded goals, avoids what its lidar sees, backs out when stuck.

`Roam` does the same at changing speeds, which shows how metrics depend on speed.
"""

import math
from dataclasses import replace
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.base.sim_time import NANOSECONDS
from harness.drivers.base import DriverContext, Observation, aside, turning
from harness.samples import LaserScan, Sample, Twist

GOAL_DISTANCE = (4.0, 10.0)  # [m] from where the rover is
GOAL_REACHED = 0.6  # [m]
GOAL_PATIENCE_NS = 45 * NANOSECONDS
BORDER = 3.0  # [m] between the goals and the edge of the map
TURN_BACK_BORDER = 2.0  # [m]: nearer to the edge than this, the goal is the map's centre
STOP_RANGE = 0.45  # [m] of free range ahead below which the rover turns in place, at least
SLOW_RANGE = 1.2  # [m] below which it slows down, at least
BEFORE_BUMPER = 0.15, 0.9  # [m] of those that are ahead of the rover, at least
MARGIN = 0.12  # [m] beside the middle of the wheels that must be free
ASIDE = 0.05  # [m] beside the rover that must be
LOOKAHEAD = 3.0  # [m]: what is farther away does not matter yet
HEADINGS = np.linspace(-math.pi, math.pi, 49)[:-1]  # candidate directions, 7.5 deg apart
DIRECTIONS: list[float] = HEADINGS.tolist()
NOTHING = np.zeros(0, np.float32)  # a scan without beams
STUCK_AFTER_NS = 3 * NANOSECONDS
STUCK_DISTANCE = 0.25  # [m] of progress that shows it is not stuck
BACK_OUT_NS = 2 * NANOSECONDS
SLOWEST, FASTEST = 0.2, 0.9  # of the rover's top speed
SPELL = 8.0  # [s] at one speed


class Wander:
    """Goal seeking with a polar histogram of free range (after VFH, Borenstein and Koren 1991)."""

    summary: ClassVar[str] = "seeks seeded goals, avoids hazards by its lidar, backs out when stuck"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
        # Not at the top: kernels are loaded when a driver is made, not when drivers are only named.
        from harness.drivers.corridor_kernel import freest  # noqa: PLC0415

        self._freest = freest
        self._rover = context.rover
        self._middle = context.middle
        self._reach_x, self._reach_y = (half - BORDER for half in context.half_size)
        self._turn_back_x, self._turn_back_y = (half - TURN_BACK_BORDER for half in context.half_size)
        self._rng = context.rng
        self._bearings = context.bearings
        half_width = max(self._rover.track / 2 + MARGIN, self._rover.width / 2 + ASIDE)
        self._corridors = _corridors(context.bearings, half_width)
        overhang = self._rover.footprint[1] - self._rover.lidar_x  # ranges begin at the lidar
        stop, slow = BEFORE_BUMPER
        self._stop_range = max(STOP_RANGE, overhang + stop)
        self._slow_range = max(SLOW_RANGE, overhang + slow)
        self._goal: tuple[float, float] | None = None
        self._goal_since_ns = 0
        self._anchor = (0.0, 0.0)
        self._anchor_ns = 0
        self._back_out_until_ns = 0
        self._back_out_turn = 0.0

    def command(self, observation: Observation) -> Twist:
        """Towards the goal through the freest direction near it, or backwards when stuck."""
        if observation.time_ns < self._back_out_until_ns:
            return Twist(-0.6 * self._rover.cruise_speed, self._back_out_turn)
        if self._is_stuck(observation):
            return self._start_backing_out(observation)
        return self._steer(self._bearing_to_goal(observation), observation.ranges)

    def _bearing_to_goal(self, observation: Observation) -> float:
        x, y = self._middle
        if abs(observation.x - x) > self._turn_back_x or abs(observation.y - y) > self._turn_back_y:
            self._goal = self._middle
        here, waited_ns = (observation.x, observation.y), observation.time_ns - self._goal_since_ns
        is_late = waited_ns > GOAL_PATIENCE_NS
        if self._goal is None or is_late or math.dist(self._goal, here) < GOAL_REACHED:
            self._goal = self._next_goal(observation)
            self._goal_since_ns = observation.time_ns
        return observation.bearing_to(*self._goal)

    def _next_goal(self, observation: Observation) -> tuple[float, float]:
        distance = self._rng.uniform(*GOAL_DISTANCE)
        bearing = self._rng.uniform(-math.pi, math.pi)
        x = observation.x + distance * math.cos(bearing)
        y = observation.y + distance * math.sin(bearing)
        (at_x, at_y), reach_x, reach_y = self._middle, self._reach_x, self._reach_y
        return (max(at_x - reach_x, min(at_x + reach_x, x)), max(at_y - reach_y, min(at_y + reach_y, y)))

    def _steer(self, goal: float, ranges: NDArray[np.float32] | None) -> Twist:
        seen = NOTHING if ranges is None else ranges
        best, ahead = self._freest(seen, self._corridors, HEADINGS, goal, LOOKAHEAD)
        heading = DIRECTIONS[best]
        if ahead < self._stop_range:
            return Twist(0.0, math.copysign(self._rover.cruise_yaw_rate, heading))
        slow = min(1.0, ahead / self._slow_range) * max(0.0, math.cos(heading))
        return Twist(self._rover.cruise_speed * slow, turning(heading, self._rover, 1.5))

    def _is_stuck(self, observation: Observation) -> bool:
        here = (observation.x, observation.y)
        if math.dist(here, self._anchor) > STUCK_DISTANCE:
            self._anchor, self._anchor_ns = here, observation.time_ns
        return observation.time_ns - self._anchor_ns > STUCK_AFTER_NS

    def _start_backing_out(self, observation: Observation) -> Twist:
        side = 1.0 if self._rng.random() < 0.5 else -1.0
        self._back_out_turn = 0.5 * side * self._rover.cruise_yaw_rate
        self._back_out_until_ns = observation.time_ns + BACK_OUT_NS
        self._anchor_ns = self._back_out_until_ns
        self._goal = None
        return self.command(observation)


class Roam:
    """Goes where `Wander` goes, at a new random speed every few seconds."""

    summary: ClassVar[str] = "wanders at speeds that change every 8 s, up to 0.9 of the top speed"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))

    def __init__(self, context: DriverContext) -> None:
        self.rover, self.rng = context.rover, context.rng
        self._wander = Wander(context)
        self._scale, self._until_ns = 1.0, 0

    def spell(self) -> tuple[float, float]:
        """Returns how long the next speed holds [s], and how much of the cruising speed it is."""
        share = self.rng.uniform(SLOWEST, FASTEST)
        return SPELL, share * self.rover.top_speed / self.rover.cruise_speed

    def command(self, observation: Observation) -> Twist:
        """Returns Wander's twist, its speed scaled."""
        if observation.time_ns >= self._until_ns:
            held, self._scale = self.spell()
            self._until_ns = observation.time_ns + math.floor(held * NANOSECONDS)
        twist = self._wander.command(observation)
        return replace(twist, linear=self._scale * twist.linear)


def _corridors(bearings: NDArray[np.float64], half_width: float) -> NDArray[np.float64]:
    """Range within which a beam's return blocks a heading, shape (beams, headings) [m].

    A return at range r and angle a off the heading lies r sin(a) beside it: it blocks a corridor of
    the rover's half width if r < half_width / sin(a), and never when it lies behind.
    """
    off = aside(bearings[:, None] - HEADINGS[None, :])
    with np.errstate(divide="ignore"):
        corridor = np.where(off < math.pi / 2, half_width / np.sin(off), 0.0)
    return np.minimum(corridor, LOOKAHEAD)
