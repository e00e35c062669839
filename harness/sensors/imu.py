"""The IMU: specific force and angular rate, averaged over every step of the sample's window.

A single step would alias the contacts' high frequencies into the reading; a real sensor filters them
(facts: models/README.md). The frame is that of the site `imu`.
"""

import mujoco
import numpy as np

from harness.physics.simulation import Simulation
from harness.samples import Imu, Quaternion, Vector3
from harness.sensors.base import Sensor


class ImuSensor(Sensor):
    """Averages over its window; call `observe` after every tick, `read` at the end of the window."""

    def __init__(self, simulation: Simulation, period_ticks: int) -> None:
        super().__init__(simulation, period_ticks)
        self._steps = 0  # in the window so far
        self._force_in_tick = simulation.summed("imu_accelerometer")
        self._rate_in_tick = simulation.summed("imu_gyro")
        self._force_sum, self._rate_sum = np.zeros(3), np.zeros(3)
        self._mounting = simulation.model.site("imu").quat.copy()
        self._attitude = np.empty(4)

    def observe(self) -> None:
        """Adds the tick that has just been simulated to the window."""
        self._force_sum += self._force_in_tick
        self._rate_sum += self._rate_in_tick
        self._steps += self._simulation.steps_per_tick

    def read(self) -> Imu:
        """Returns the window's means [m/s^2, rad/s] and the attitude at its end; starts a new window."""
        reading = Imu(
            stamp_ns=self._simulation.time_ns,
            orientation=self._orientation(),
            angular_velocity=_vector(self._rate_sum / self._steps),
            linear_acceleration=_vector(self._force_sum / self._steps),
        )
        self.after_reset()
        return reading

    def after_reset(self) -> None:
        """Starts a new window; what is in the present one is never read."""
        self._force_sum.fill(0.0)
        self._rate_sum.fill(0.0)
        self._steps = 0

    def _orientation(self) -> Quaternion:
        mujoco.mju_mulQuat(self._attitude, self._simulation.data.qpos[3:7], self._mounting)
        w, x, y, z = self._attitude.tolist()
        return x, y, z, w


def _vector(values: np.ndarray) -> Vector3:
    x, y, z = values.tolist()
    return x, y, z
