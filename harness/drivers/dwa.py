"""The dynamic window approach (Fox, Burgard and Thrun 1997) as the BARN challenge ships it.

That is ROS' base_local_planner with the settings of Daffan/the-barn-challenge at bf5a226 (jackal_helper,
base_local_planner_params.yaml, costmap_common_params.yaml), on a map of what the lidar has seen: every
twist is driven ahead for 2 s with the padded footprint; the cheapest end wins; where none is free, the
rover turns on the spot, else it backs up.
"""

import math
from collections.abc import Mapping
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from harness.drivers.base import DriverContext, Observation
from harness.drivers.beeline import Beeline
from harness.samples import LaserScan, Sample, Twist

SPEED, RATE = (0.1, 0.5), 1.57  # [m/s], [rad/s]
SPEEDS, RATES = 6, 20
FASTER = 1.0  # [rad/s]: 20 rad/s^2 over a period; 10 m/s^2 reach every speed
LEAST_TURN = 0.314  # [rad/s] on the spot
STEP, STEPS = 0.1, 20  # [s]: 2 s in all
PADDING = 0.08, 0.055  # [m] ahead and aside; with it the Jackal's footprint is BARN's 0.62 x 0.53 m
SPACING = 0.05  # [m] between points of the footprint's outline
# Cost within the half width of what is occupied [m]; it fades by a rate [1/m] and ends beyond [m].
INSCRIBED, FADING, FADED = 253.0 * 0.005, 10.0, 0.035
LOOKED_AHEAD = 0.325  # [m], for turns on the spot
ESCAPED = 0.1, 0.1  # [m], [rad] of backing up
BACK = -0.5  # [m/s]
PLANNED_EVERY = 4  # periods
# The map of costs: its ranges and its inflation.
MAP = {"marked": 2.5, "cleared": 3.0, "margin": PADDING[1], "ring": FADED, "shyness": 4.0}


class Dwa(Beeline):
    """Drives to each goal by the twist that leads on best."""

    summary: ClassVar[str] = "drives to each /goal_pose by the dynamic window approach on a local map"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset((LaserScan,))
    map_options: ClassVar[Mapping[str, float]] = MAP  # of local_map.MapOptions
    decides_every: ClassVar[int] = 2  # periods: 10 Hz, at which its goal comes and stops it for a cycle

    def __init__(self, context: DriverContext) -> None:
        # Not at the top: kernels are loaded when a driver is made, not when drivers are only named.
        from harness.drivers import base_local_planner, local_map, rollout  # noqa: PLC0415

        super().__init__(context)
        self._planner, self._rollout = base_local_planner, rollout
        self._map = local_map.LocalMap(context, local_map.MapOptions(**self.map_options))
        self._inscribed = 0.5 * context.rover.width + PADDING[1]
        self._outline = self._outlined()
        self._last, self._count = Twist(), 0
        self._turns = base_local_planner.Turns()
        self._backed: tuple[float, float, float] | None = None  # from where, and its heading

    def head_for(self, x: float, y: float, yaw: float) -> None:
        """Takes the next goal [m]; it arrives there with any heading."""
        super().head_for(x, y, yaw)
        self._count = 0

    def command(self, observation: Observation) -> Twist:
        """Returns the twist that leads on best; zero at the goal, and before the first one."""
        self._map.see(observation)
        self._last = super().command(observation)
        return self._last

    def towards(self, goal: tuple[float, float], observation: Observation) -> Twist:
        """Returns the twist that leads to a goal best."""
        if self._count % PLANNED_EVERY == 0:
            self._map.plan((observation.x, observation.y), goal)
            self._corner = self._map.corner
            self._ends = self._place_costs(self._map.cell((observation.x, observation.y)))
        self._count += 1
        due = self._count % self.decides_every == 1 % self.decides_every
        return self._best(goal, observation) if due else self._last

    def _place_costs(self, here: tuple[int, int]) -> NDArray[np.float64]:
        """What it costs to end in each cell [m]."""
        return self._planner.place_costs(self._map, here, self._inscribed)

    def _best(self, goal: tuple[float, float], observation: Observation) -> Twist:
        here = observation.x, observation.y
        twists = self._twists(math.dist(goal, here))
        cost, ahead = self._costs(twists, observation)
        on_the_spot = twists[:, 0] == 0.0
        forward = np.where(on_the_spot | self._is_escaping(observation), np.inf, cost)
        turns = on_the_spot & np.isfinite(cost) & (cost <= forward.min())
        turns &= self._turns.allowed(here, twists[:, 1])
        if turns.any():
            best = int(np.argmin(np.where(turns, ahead, np.inf)))
            self._turns.take(here, float(twists[best, 1]))
        elif math.isfinite(forward.min()):
            best = int(np.argmin(forward))
        else:
            self._backed = self._backed or (*here, observation.yaw)
            return Twist(BACK)
        return Twist(float(twists[best, 0]), float(twists[best, 1]))

    def _costs(
        self, twists: NDArray[np.float64], observation: Observation
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The cost of each twist, inf for those that touch, and that of a place ahead of its end [m]."""
        plans = np.repeat(twists[:, None], STEPS, axis=1)
        of = self._rollout
        outcomes = self._rolled(observation, plans, STEP, self._inscribed, LOOKED_AHEAD)
        beyond = np.maximum(outcomes[:, of.ROOM] - self._inscribed, 0.0)
        # Approximates exp, with the same bits everywhere.
        fading = 1.0 + FADING * beyond * (1.0 + 0.5 * FADING * beyond)
        cost = outcomes[:, of.END] + np.where(beyond > FADED, 0.0, INSCRIBED / fading)
        cost[(outcomes[:, of.ROOM] <= 0.0) | np.isinf(outcomes[:, of.FARTHEST])] = np.inf
        return cost, outcomes[:, of.AHEAD]

    def _is_escaping(self, observation: Observation) -> bool:
        """Whether it has not backed up far enough to go ahead again."""
        if self._backed is not None:
            far = math.dist(self._backed[:2], (observation.x, observation.y)) > ESCAPED[0]
            turn = math.remainder(self._backed[2] - observation.yaw, math.tau)
            if far or abs(turn) > ESCAPED[1]:
                self._backed = None
        return self._backed is not None

    def _twists(self, distance: float) -> NDArray[np.float64]:
        """The twists that are tried: straight on, then in curves, then on the spot."""
        low, top = SPEED
        speeds = np.linspace(low, max(low, min(top, self.rover.top_speed, distance / 2.0)), SPEEDS)
        last = self._last.angular
        rates = np.linspace(max(-RATE, last - FASTER), min(RATE, last + FASTER), RATES)
        turns = np.copysign(np.maximum(np.abs(rates), LEAST_TURN), rates)
        curves = np.append(0.0, rates)
        ahead = np.column_stack([np.repeat(speeds, len(curves)), np.tile(curves, SPEEDS)])
        return np.concatenate([ahead, np.column_stack([np.zeros(RATES), turns])])

    def _rolled(
        self, seen: Observation, plans: NDArray[np.float64], step: float, close: float, ahead: float
    ) -> NDArray[np.float64]:
        """What `rolled` finds of plans from where the rover is."""
        x, y = self._corner
        pose = np.array([seen.x - x, seen.y - y, math.cos(seen.yaw), math.sin(seen.yaw)])
        given = self._map.clearance, self._ends, pose, plans, step, self._outline, close, ahead
        return self._rollout.rolled(*given)

    def _outlined(self) -> NDArray[np.float64]:
        """Points around the padded footprint."""
        (x_min, x_max, y_min, y_max), (ahead, aside) = self.rover.footprint, PADDING
        x_min, x_max, y_min, y_max = x_min - ahead, x_max + ahead, y_min - aside, y_max + aside
        along = np.linspace(x_min, x_max, math.ceil((x_max - x_min) / SPACING) + 1)
        across = np.linspace(y_min, y_max, math.ceil((y_max - y_min) / SPACING) + 1)[1:-1]
        sides = [(x, y, 0.0) for y in (y_min, y_max) for x in along]
        return np.array(sides + [(x, y, 0.0) for x in (x_min, x_max) for y in across])
