"""Drivers that see nothing: the one that is driven over /cmd_vel, and fixed manoeuvres."""

import math
from typing import ClassVar

from harness.drivers.base import DriverContext, Observation
from harness.samples import Sample, Twist

STRAIGHT_SPEED = 0.3  # [m/s]: a default run of 60 s ends before the edge of a 40 m map
TURN_RADIUS = 1.5  # [m] of each circle of the eight


class OpenLoop:
    """One twist, `latest`, whatever is observed."""

    senses: ClassVar[frozenset[type[Sample]]] = frozenset()

    def __init__(self, twist: Twist) -> None:
        self.latest = twist

    def command(self, observation: Observation) -> Twist:  # noqa: ARG002 - open loop
        """Returns the twist in force."""
        return self.latest


class CmdVel(OpenLoop):
    """Driven over /cmd_vel by a human, Nav2 or an RL agent; stands still before the first command.

    As in Gazebo's DiffDrive a command holds until the next one; with a timeout, as on real base drivers,
    for so long at most.
    """

    summary: ClassVar[str] = "listens to /cmd_vel (geometry_msgs/Twist or TwistStamped)"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(Twist())
        self._timeout_ns = context.command_timeout_ns
        self._since_ns: int | None = None
        self._held = False

    def obey(self, twist: Twist, *, held: bool = False) -> None:
        """Takes the next command; one that is held knows no time-out."""
        self.latest, self._since_ns, self._held = twist, None, held

    def command(self, observation: Observation) -> Twist:
        """Returns the twist in force, which stands from the next control period on."""
        if self._since_ns is None:
            self._since_ns = observation.time_ns
        age_ns = observation.time_ns - self._since_ns
        is_over = self._timeout_ns is not None and not self._held and age_ns >= self._timeout_ns
        return Twist() if is_over else self.latest


class Straight(OpenLoop):
    """Drives straight ahead."""

    summary: ClassVar[str] = "straight ahead at 0.3 m/s"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(Twist(linear=min(STRAIGHT_SPEED, context.rover.cruise_speed)))


class Spin(OpenLoop):
    """Turns in place."""

    summary: ClassVar[str] = "turns left in place"

    def __init__(self, context: DriverContext) -> None:
        super().__init__(Twist(angular=context.rover.cruise_yaw_rate))


class Figure8:
    """Two circles, left then right; each ends when the heading has come round."""

    summary: ClassVar[str] = "left and right circles of 1.5 m radius in turn"
    senses: ClassVar[frozenset[type[Sample]]] = frozenset()

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
