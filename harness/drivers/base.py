"""What a driver is: from what the rover can know to a twist, once per control period."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.samples import Sample, Twist
from harness.world.obstacles import Obstacle
from rover_metrics.plugins import misfit

OF_POLICY = "policy:"  # of a driver's name, before that of a file
BACKWARDS, SLOWEST = 0.6, 0.4  # of the cruising speed, of rovers that cannot turn in place


@dataclass(frozen=True, slots=True)
class Observation:
    """What a driver may use."""

    time_ns: int  # simulation time since the drive began, at the start or at a reset
    x: float  # position in the world, as a localisation would give it [m]
    y: float  # position in the world [m]
    yaw: float  # heading [rad]
    ranges: NDArray[np.float32] | None  # the last scan, shape (beams,), or None before the first
    touches_hazard: bool = False  # what a bumper all around the rover would feel; for staged encounters
    # the last sample of each kind that is read
    readings: Mapping[type[Sample], Sample] = field(default_factory=dict)

    def turn_to(self, heading: float) -> float:
        """Returns the angle from the rover's heading to another [rad], -pi to pi."""
        return math.remainder(heading - self.yaw, math.tau)

    def bearing_to(self, x: float, y: float) -> float:
        """Returns the angle from the rover's heading to a point of the world [rad], left positive."""
        return self.turn_to(math.atan2(y - self.y, x - self.x))


@dataclass(frozen=True, eq=False)
class DriverContext:
    """What a driver is made for."""

    rover: RoverSpec  # the rover to drive
    # half the lengths of the map along x and y, or of what of it can be driven [m]
    half_size: tuple[float, float]
    # direction [rad] of each lidar beam in the rover's frame, 0 ahead, left positive
    bearings: NDArray[np.float64]
    rng: np.random.Generator  # the driver's own source of randomness
    # what stands in the world; only a driver that stages encounters may look
    obstacles: tuple[Obstacle, ...] = ()
    command_timeout_ns: int | None = None  # after which a command of /cmd_vel ends; None for never
    middle: tuple[float, float] = (0.0, 0.0)  # of the map, in the world: x, y [m]
    reach: float = math.inf  # how near to its goals an area or a route wants the rover [m]


class Driver(Protocol):
    """Chooses the command; made from a `DriverContext`."""

    summary: ClassVar[str]
    senses: ClassVar[frozenset[type[Sample]]]  # the samples that it looks at

    def __init__(self, context: DriverContext) -> None: ...

    def command(self, observation: Observation) -> Twist:
        """Returns the twist for the next control period."""
        ...


@runtime_checkable
class TakesGoals(Protocol):
    """A driver that goes to goals, which /goal_pose or a plan gives it."""

    def head_for(self, x: float, y: float, yaw: float, /) -> None:
        """Takes the next goal.

        Args:
            x: In the world [m].
            y: In the world [m].
            yaw: Heading there [rad]; a driver may arrive with any other.
        """
        ...


def aside(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns how far directions are from straight ahead, to either side, 0 to pi [rad]."""
    return np.abs(np.remainder(angles + math.pi, math.tau) - math.pi)


def turning(error: float, rover: RoverSpec, gain: float = 2.0) -> float:
    """Returns the yaw rate that turns a rover towards a heading [rad/s].

    Args:
        error: From its heading to that one, positive to the left [rad].
        rover: Its cruising yaw rate is the limit.
        gain: Share of the cruising yaw rate for each radian.
    """
    return max(-1.0, min(1.0, gain * error)) * rover.cruise_yaw_rate


def commanded(driver: Driver, observation: Observation) -> Twist:
    """Returns what a driver wants; a MisfitError names one that gives no Twist of two numbers."""
    twist = driver.command(observation)
    if not (isinstance(twist, Twist) and _is_number(twist.linear) and _is_number(twist.angular)):
        raise misfit(driver, twist, "a Twist of two numbers")
    return twist


def drivable(twist: Twist, rover: RoverSpec) -> Twist:
    """Returns a twist that the rover can follow, nearest to what a driver wants.

    Turning in place becomes backing up in the tightest curve, which turns the heading the same way and
    leaves what is ahead; a slow tight curve is driven fast enough to get round.
    """
    if not rover.steers or twist.angular == 0.0:
        return twist
    needed = abs(twist.angular) * rover.tightest_turn  # [m/s]
    if twist.linear == 0.0:
        return Twist(-min(needed, BACKWARDS * rover.cruise_speed), twist.angular)
    slowest = min(needed, SLOWEST * rover.cruise_speed)
    return Twist(math.copysign(max(abs(twist.linear), slowest), twist.linear), twist.angular)


def _is_number(value: Any) -> bool:  # noqa: ANN401 - whatever a driver gives
    return hasattr(value, "__float__") and not getattr(value, "ndim", 0)
