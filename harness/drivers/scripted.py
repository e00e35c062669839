"""Drivers that follow a fixed manoeuvre: straight, spin, figure8."""

import math
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation
from harness.samples import Twist

STRAIGHT_SPEED = 0.3  # [m/s]: a default run of 60 s ends before the edge of a 40 m map
TURN_RADIUS = 1.5  # [m] of each circle of the eight


class Constant:
    """One twist for ever, open loop."""

    def __init__(self, twist: Twist) -> None:
        self._twist = twist

    def command(self, observation: Observation) -> Twist:  # noqa: ARG002 - open loop
        """Returns the same twist at any time."""
        return self._twist


class Straight(Constant):
    """Straight ahead."""

    summary: ClassVar[str] = "straight ahead at 0.3 m/s"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(Twist(linear=min(STRAIGHT_SPEED, context.rover.cruise_speed)))


class Spin(Constant):
    """Turning in place."""

    summary: ClassVar[str] = "turns left in place"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(Twist(angular=context.rover.cruise_yaw_rate))


class Figure8:
    """Two circles, left then right; each ends when the heading has come round."""

    summary: ClassVar[str] = "left and right circles of 1.5 m radius in turn"

    def __init__(self, context: DriverContext) -> None:
        self._speed = context.rover.cruise_speed
        self._side = 1.0
        self._turned = 0.0
        self._yaw: float | None = None

    def command(self, observation: Observation) -> Twist:
        """Curves to the present side until a full turn is done."""
        if self._yaw is not None:
            self._turned += math.remainder(observation.yaw - self._yaw, math.tau)
        self._yaw = observation.yaw
        if self._side * self._turned >= math.tau:
            self._side, self._turned = -self._side, 0.0
        # A skid-steer turns less than commanded; steer by the heading it should have by now.
        return Twist(linear=self._speed, angular=self._side * 2.0 * self._speed / TURN_RADIUS)
