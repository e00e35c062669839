"""Wheel odometry: what a rover's controller integrates from its quantised encoders.

It uses the controller's radius and separation, so it inherits their errors and the skid's, as
RoboTerrain's DiffDrive odometry does. A rover with steered wheels integrates the way of the others
along the curve that its steering's angles mean. Planar, in the odom frame, zero at the start; it knows
nothing of a rover that is carried to another place.
"""

import math

import numpy as np

from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.physics.base_controller import curvature_of
from harness.physics.simulation import Simulation
from harness.samples import Odometry, Twist
from harness.sensors.base import EpisodeParts, Sensor


class WheelOdometry(Sensor):
    """Integrates the encoder counts between two readings.

    Args:
        simulation: Of the rover.
        period_ticks: Between two readings.
        wheel_scale: Radius of the wheels, left and right, over the one that the controller believes, as
            far as the model has it: by noise.
    """

    def __init__(
        self, simulation: Simulation, period_ticks: int, wheel_scale: tuple[float, float] = (1.0, 1.0)
    ) -> None:
        super().__init__(simulation, period_ticks)
        self._rover = simulation.scene.rover
        model, own = simulation.model, simulation.scene.own
        drive, steered = self._rover.drive, self._rover.steered_wheels
        self._qpos, self._steers = simulation.data.qpos, self._rover.steers
        read = self._rover.wheel_joints if self._rover.steers else drive.driven
        self._read = [name for name in read if name not in steered]
        self._left = [place for place, name in enumerate(self._read) if name in drive.left]
        self._right = [place for place, name in enumerate(self._read) if name in drive.right]
        self._angles = np.array([int(model.joint(own(n)).qposadr[0]) for n in self._read])
        self._steering = np.array([int(model.joint(own(n)).qposadr[0]) for n in drive.steering], int)
        self._counts_per_radian = self._rover.encoder_ticks / math.tau
        self._metres_per_count = math.tau * self._rover.controller_radius / self._rover.encoder_ticks
        self._left_scale, self._right_scale = wheel_scale
        self._period = period_ticks * TICK_NS / NANOSECONDS
        self._counts = self._kept = self._encoders()
        self._x = self._y = self._yaw = 0.0

    @classmethod
    def of(cls, parts: EpisodeParts, period_ticks: int) -> "WheelOdometry":
        """Returns the wheel odometry of an episode."""
        return cls(parts.simulation, period_ticks, parts.wheel_scale)

    def _encoders(self) -> list[int]:
        counts_per_radian, angles = self._counts_per_radian, self._qpos[self._angles].tolist()
        return [math.floor(angle * counts_per_radian) for angle in angles]

    def before_reset(self) -> None:
        """Notes the counts, which a rover that is put elsewhere does not change."""
        self._kept = self._encoders()

    def after_reset(self) -> None:
        """Goes on from the counts before."""
        moved = zip(self._counts, self._kept, self._encoders(), strict=True)
        self._counts = [last + now - kept for last, kept, now in moved]

    def read(self) -> Odometry:
        """Returns the pose integrated to now and the mean twist since the last reading."""
        counts = self._encoders()
        distance, turn = self._rolled(counts)
        self._x, self._y, self._yaw = self._moved(distance, turn)
        self._counts = counts
        twist = Twist(distance / self._period, turn / self._period)
        return Odometry(self._simulation.time_ns, self._x, self._y, self._yaw, twist)

    def pose(self) -> tuple[float, float, float]:
        """Returns x, y [m] and yaw [rad] as a reading now would have them; takes none."""
        return self._moved(*self._rolled(self._encoders()))

    def _rolled(self, counts: list[int]) -> tuple[float, float]:
        """The way [m] and the turn [rad] since the last reading."""
        since, metres = zip(counts, self._counts, strict=True), self._metres_per_count
        rolled = [(now - before) * metres for now, before in since]
        left = sum([rolled[place] for place in self._left]) / len(self._left) / self._left_scale
        right = sum([rolled[place] for place in self._right]) / len(self._right) / self._right_scale
        distance, separation = (left + right) / 2, self._rover.controller_separation
        if not self._steers:
            return distance, (right - left) / separation
        angles = self._qpos[self._steering].tolist()
        return distance, distance * curvature_of(angles, self._rover.wheelbase, separation)

    def _moved(self, distance: float, turn: float) -> tuple[float, float, float]:
        """The pose after a way [m] and a turn [rad] since the last reading."""
        heading = self._yaw + turn / 2
        x = self._x + distance * math.cos(heading)
        y = self._y + distance * math.sin(heading)
        return x, y, math.remainder(self._yaw + turn, math.tau)
