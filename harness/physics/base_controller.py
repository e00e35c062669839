"""cmd_vel -> wheel commands, by the rover's kind of drive.

A controller limits the acceleration of the commanded twist, latches the last command (Gazebo's has no
timeout) and believes the wheel radius and separation of its own configuration, which for rover_zero4wd
are not those of the model (facts: models/README.md).
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from harness.robots import RoverSpec
from harness.robots.sections import Actuators
from harness.samples import Twist

STILL = 1e-3  # [rad/s]: a speed that has faded below it is none, and the rover parks
CREEPING = 1e-6  # [m/s]: slower is no speed, and has no curvature


class BaseController(ABC):
    """What makes wheel commands of a twist."""

    def __init__(self, rover: RoverSpec, period: float) -> None:
        self._radius = rover.controller_radius
        self._linear_step = rover.linear_acceleration * period
        self._target = Twist()
        self._linear = 0.0

    def command(self, twist: Twist) -> bool:
        """Latches a command; returns whether it is finite, for else the previous one stays."""
        if not (math.isfinite(twist.linear) and math.isfinite(twist.angular)):
            return False
        self._target = twist
        return True

    def ahead(self, periods: int) -> NDArray[np.float64]:
        """Returns what `Simulation.command_ahead` takes, for so many periods."""
        rows = list[Sequence[float]]()
        while len(rows) < periods:
            holds = self.holds
            rows.append(self.commands())
            if holds:
                rows += rows[-1:] * (periods - len(rows))
        return np.array(rows)

    @property
    def holds(self) -> bool:
        """Whether the next commands are those of all periods after it, too, until another twist."""
        return False

    def wheel_speeds(self) -> NDArray[np.float64]:
        """Returns what `Simulation.command_wheels` takes, once per period."""
        return np.array(self.commands())

    @abstractmethod
    def commands(self) -> Sequence[float]:
        """The next period's commands, in the order of the rover's `motors`."""


class DiffDrive(BaseController):
    """Controller of a rover that turns by its sides' difference, as RoboTerrain's Gazebo DiffDrive."""

    def __init__(self, rover: RoverSpec, period: float) -> None:
        super().__init__(rover, period)
        self._half_separation = rover.controller_separation / 2
        self._on_left = [name in rover.drive.left for name in rover.drive.driven]
        self._angular_step = rover.angular_acceleration * period
        self._angular = 0.0

    def commands(self) -> list[float]:
        """Returns the speeds of the driven wheels [rad/s], in the order of the rover's `motors`."""
        self._linear = approach(self._linear, self._target.linear, self._linear_step)
        self._angular = approach(self._angular, self._target.angular, self._angular_step)
        half_difference = self._angular * self._half_separation
        left = (self._linear - half_difference) / self._radius
        right = (self._linear + half_difference) / self._radius
        return [left if on_left else right for on_left in self._on_left]

    @property
    def holds(self) -> bool:
        """Whether it has come to what is commanded."""
        return self._linear == self._target.linear and self._angular == self._target.angular


class Ackermann(BaseController):
    """Controller of a rover that steers its front wheels like a car.

    The middle of the unsteered axles follows the commanded curvature, angular over linear, as far as the
    steering turns; each wheel rolls about the same centre, so that none skids:

        angle of a steered wheel beside the middle by y:  atan(L k / (1 - k y))
        speed of a wheel:                                 v sqrt((1 - k y)^2 + (k x)^2)

    with x = L, the wheelbase, of the steered wheels and 0 of the others, and y = +- half the separation
    that the controller believes. A twist without linear speed steers and does not move. Curvature
    changes as fast as the steering turns; while nothing is commanded the wheels stay as they are.
    """

    def __init__(self, rover: RoverSpec, period: float) -> None:
        super().__init__(rover, period)
        drive, half, self._wheelbase = rover.drive, rover.controller_separation / 2, rover.wheelbase
        self._limit = 1.0 / rover.tightest_turn  # of the curvature [1/m]
        self._turn_step = drive.steering_rate * period
        self._aside = np.array([half if name in drive.left else -half for name in drive.driven])
        steered = [name in rover.steered_wheels for name in drive.driven]
        self._ahead = np.where(steered, rover.wheelbase, 0.0)
        self._steered_aside = np.array([half, -half])
        self._steering = 0.0  # of a wheel in the middle [rad]

    def commands(self) -> list[float]:
        """Returns the speeds of the driven wheels [rad/s], then left and right steering angle [rad]."""
        self._linear = approach(self._linear, self._target.linear, self._linear_step)
        self._steering = approach(self._steering, self._wanted(), self._turn_step)
        curvature = math.tan(self._steering) / self._wheelbase
        rolling = np.hypot(1.0 - curvature * self._aside, curvature * self._ahead)
        speeds = self._linear * rolling / self._radius
        angles = np.arctan2(self._wheelbase * curvature, 1.0 - curvature * self._steered_aside)
        return [*speeds.tolist(), *angles.tolist()]

    def _wanted(self) -> float:
        """The angle of a wheel in the middle that the command asks for [rad]."""
        linear, angular = self._target.linear, self._target.angular
        if angular == 0.0:
            return self._steering if linear == 0.0 else 0.0
        if abs(linear) < CREEPING:
            curvature = math.copysign(self._limit, angular)
        else:
            curvature = max(-self._limit, min(self._limit, angular / linear))
        return math.atan(self._wheelbase * curvature)


def base_controller(rover: RoverSpec, period: float) -> BaseController:
    """Returns the controller of a rover's kind of drive.

    Args:
        rover: The rover.
        period: From one call of `wheel_speeds` to the next [s].
    """
    ideal = Ackermann(rover, period) if rover.steers else DiffDrive(rover, period)
    if not rover.real or rover.actuators is None:
        return ideal
    return LaggingController(ideal, rover, rover.actuators, period)


class LaggingController(BaseController):
    """The controller of a rover whose motors are real, behind the one of its kind of drive.

    What that makes of commands comes `delay` late; it is limited and goes through two lags of first
    order, whose sum is `lag`, to the wheels: the response of a speed loop is an S.

    Args:
        controller: Of its kind of drive.
        rover: The rover.
        actuators: What its motors can do.
        period: From one call of `wheel_speeds` to the next [s].
    """

    def __init__(
        self, controller: BaseController, rover: RoverSpec, actuators: Actuators, period: float
    ) -> None:
        super().__init__(rover, period)
        self._controller, self._driven = controller, len(rover.drive.driven)
        on_left = [name in rover.drive.left for name in rover.drive.driven]
        self._left = [n for n, is_left in enumerate(on_left) if is_left]
        self._right = [n for n, is_left in enumerate(on_left) if not is_left]
        ticks, self._part = divmod(actuators.delay / period, 1.0)
        self._late = [list(controller.commands())] * (int(ticks) + 1)
        self._dead = actuators.dead_band / self._radius
        self._turn = (actuators.turn_limit or math.inf) / self._radius
        self._keep = float(np.exp(-2.0 * period / actuators.lag)) if actuators.lag else 0.0
        self._half_way = self._there = [0.0] * self._driven  # of so few, numpy is slower than lists

    def commands(self) -> list[float]:
        """Returns the present wheel commands, in the order of the controller of its kind of drive."""
        return self._rows(1)[0]

    def ahead(self, periods: int) -> NDArray[np.float64]:
        """Returns what `Simulation.command_ahead` takes, for so many periods."""
        return np.array(self._rows(periods))

    def _rows(self, periods: int) -> list[list[float]]:
        """The next periods' commands: those of a delay ago, between two periods, limited and late."""
        self._controller.command(self._target)
        made = [*self._late, *self._controller.ahead(periods).tolist()]
        self._late = made[periods:]
        rows, part = list[list[float]](), self._part
        for n, (earlier, later) in enumerate(pairwise(made[: periods + 1])):
            if not n or earlier != made[n - 1] or later != earlier:  # else it is as a period ago
                commanded = [b + part * (a - b) for a, b in zip(earlier, later, strict=True)]
                wanted = self._limited(commanded[: self._driven])
            rows.append([*self._lagged(wanted), *commanded[self._driven :]])
        return rows

    def _lagged(self, wanted: Sequence[float]) -> Sequence[float]:
        """Speeds of the wheels [rad/s], a period later."""
        keep = self._keep
        self._half_way = [w + keep * (h - w) for w, h in zip(wanted, self._half_way, strict=True)]
        self._there = [h + keep * (t - h) for h, t in zip(self._half_way, self._there, strict=True)]
        if not any(wanted) and all(abs(speed) < STILL for speed in self._there):
            self._half_way = self._there = [0.0] * self._driven
        return self._there

    def _limited(self, speeds: Sequence[float]) -> Sequence[float]:
        """Speeds [rad/s] as the motors' drivers take them."""
        speeds = [0.0 if abs(speed) < self._dead else speed for speed in speeds]
        if self._turn == math.inf:
            return speeds
        faster = mean_of(speeds, self._right) - mean_of(speeds, self._left)
        excess = abs(faster) - self._turn
        if excess > 0.0:
            half = math.copysign(excess / 2, faster)
            return [speed + (half if n in self._left else -half) for n, speed in enumerate(speeds)]
        return speeds


def curvature_of(angles: list[float], wheelbase: float, separation: float) -> float:
    """Returns the mean curvature that the left and the right steering angle mean [1/m].

    Args:
        angles: Of the left and the right steered wheel [rad].
        wheelbase: From the unsteered axle to the steered one [m].
        separation: Of the steered wheels [m].
    """
    left, right = (math.tan(angle) for angle in angles)
    half = separation / 2
    return (left / (wheelbase + half * left) + right / (wheelbase - half * right)) / 2


def approach(value: float, target: float, step: float) -> float:
    """Returns a value that is nearer to a target.

    Args:
        value: Any unit.
        target: Same unit.
        step: The largest change, not negative.
    """
    return value + max(-step, min(step, target - value))


def mean_of(values: Sequence[float], chosen: Sequence[int]) -> float:
    """Returns the mean of the values at some places."""
    return sum(values[n] for n in chosen) / len(chosen)
