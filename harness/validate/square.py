"""Wheel odometry over a square: what it states against the truth.

The rover drives by its true heading and stops before each turn. A skid-steer's wheels turn further
than the rover, so odometry believes the turns to be 1 / yaw ratio too wide.
"""

import cmath
import math
from collections.abc import Callable, Iterator

from harness.base.sim_time import TICK, period_ticks
from harness.robots import RoverSpec
from harness.robots.sections import Span
from harness.sensors.odometry import WheelOdometry
from harness.validate.check import Check, around
from harness.validate.grounds import floor
from harness.validate.rig import Rig

SIDE, SPEED, YAW_RATE = 2.0, 0.4, 1.0  # [m], [m/s], [rad/s]
CORNER = math.pi / 2
PAUSE, PATIENCE = 0.5, 20.0  # [s]


class Journey:
    """Follows a rig: what odometry states of its way, and what is true.

    Attributes:
        stated_path, true_path: Distance along the heading [m].
        stated_yaw, true_yaw: Turn, full turns counted [rad].
        stated_place, true_place: Position relative to the start, x + iy [m].
    """

    def __init__(self, rig: Rig) -> None:
        self._rig = rig
        self._period_ticks = period_ticks(rig.rover.odometry_rate)
        self._odometry = WheelOdometry(rig.simulation, self._period_ticks)
        self._start = self._last = rig.stance
        self._ticks = 0
        self.stated_path = self.true_path = self.stated_yaw = self.true_yaw = 0.0
        self.stated_place = self.true_place = 0j
        rig.observers.append(self._observe)

    def _observe(self) -> None:
        last, now = self._last, self._rig.stance
        moved = complex(now.ahead - last.ahead, now.aside - last.aside)
        self.true_path += (moved * cmath.exp(1j * (self._rig.heading - last.yaw))).real
        self.true_yaw = now.yaw - self._start.yaw
        self.true_place = complex(now.ahead - self._start.ahead, now.aside - self._start.aside)
        self._last = now
        self._ticks += 1
        if self._ticks % self._period_ticks == 0:
            reading, period = self._odometry.read(), self._period_ticks * TICK
            self.stated_path += reading.twist.linear * period
            self.stated_yaw += reading.twist.angular * period
            self.stated_place = complex(reading.x, reading.y)


def checks(rover: RoverSpec, seed: int) -> Iterator[Check]:
    """Yaw, path and place by odometry, against the truth; a rover that steers drives a circle."""
    if rover.steers:
        yield from _circle(rover, seed)
        return
    journey = _drive_square(Rig(rover, floor(seed)))
    ratio = rover.expected.yaw_ratio
    widest = 1 / ratio.low if ratio.low > 0.0 else math.inf
    wide = Span(1 / ratio.high, widest, f"D: 1 / yaw ratio; {ratio.source}")
    widening = journey.stated_yaw / (journey.true_yaw or math.nan)
    yield Check("odometry over a square, yaw told / true", "", wide, widening, digits=2)
    believed = rover.controller_radius / rover.wheel_radius
    rolling = Span(believed, 1.03 * believed, "S: believed / true wheel radius; D: sink, slip to 3 %")
    stretch = journey.stated_path / journey.true_path
    yield Check("odometry over a square, path told / true", "", rolling, stretch)
    stated = _open_polygon(journey.stated_path / 4, journey.stated_yaw / 4)
    true = _open_polygon(journey.true_path / 4, journey.true_yaw / 4)
    span = around(abs(stated - true), 0.3, "D: ends of the polygons with the told and the true corners")
    off = abs(journey.stated_place - journey.true_place)
    yield Check("odometry over a square, error of place", "m", span, off, digits=2)


def _circle(rover: RoverSpec, seed: int) -> Iterator[Check]:
    rig = Rig(rover, floor(seed))
    journey = Journey(rig)
    rate = 0.5 * SPEED / rover.tightest_turn
    _drive(rig, SPEED, rate, lambda: journey.true_yaw, math.tau)
    span = around(1.0, 0.1, "D: steered wheels roll about one centre; E: slip to 10 %")
    turned = journey.stated_yaw / (journey.true_yaw or math.nan)
    yield Check("odometry in a circle, yaw told / true", "", span, turned, digits=2)
    rolled = journey.stated_path / (journey.true_path or math.nan)
    yield Check("odometry in a circle, path told / true", "", span, rolled)


def _drive_square(rig: Rig) -> Journey:
    journey = Journey(rig)
    braking = YAW_RATE / (2 * rig.rover.angular_acceleration)  # [s] of the yaw rate's mean
    for corner in range(1, 5):
        _drive(rig, SPEED, 0.0, lambda: journey.true_path, journey.true_path + SIDE)
        # Stops early by the angle that braking takes.
        _drive(rig, 0.0, YAW_RATE, lambda: journey.true_yaw + braking * rig.yaw_rate, corner * CORNER)
    return journey


def _drive(rig: Rig, speed: float, yaw_rate: float, done: Callable[[], float], goal: float) -> None:
    """Drives until `done` reaches `goal`, then stops."""
    rig.command(speed, yaw_rate)
    rig.run_until(lambda: done() >= goal, PATIENCE)
    rig.command()
    rig.run(PAUSE)


def _open_polygon(side: float, corner: float) -> complex:
    """End of four sides [m] that meet at that corner [rad]."""
    return sum((side * cmath.exp(1j * corner * k) for k in range(4)), 0j)
