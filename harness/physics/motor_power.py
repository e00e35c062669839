"""What the motors of a rover draw, from torques and speeds over a clock tick.

A motor's current is its torque over the motor constant, none while the ground drags it along, as drivers
of real rovers report; what it takes from the battery is T w + R i^2, and braking gives nothing back.
"""

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.physics.actuators import MOTOR_SPEED, MOTOR_TORQUE
from harness.physics.simulation import Simulation


class MotorPower:
    """Reads a simulation whose rover has real actuators, after each of its ticks.

    Raises:
        UsageError: They are not real.
    """

    def __init__(self, simulation: Simulation) -> None:
        rover = simulation.scene.rover
        if rover.actuators is None or not rover.real:
            raise UsageError("what motors draw is only known of real ones; give --actuators real")
        drive, self._motor, self._simulation = rover.drive, rover.actuators, simulation
        self._torques = np.concatenate([simulation.felt(MOTOR_TORQUE + name) for name in drive.driven])
        self._speeds = np.concatenate([simulation.felt(MOTOR_SPEED + name) for name in drive.driven])
        sides = [[name in side for name in drive.driven] for side in (drive.left, drive.right)]
        self._sides = np.array(sides, float)
        self._count = np.ones(2) if self._motor.one_motor_a_side else self._sides.sum(axis=1)

    def draw(self, sums: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Returns the current of the left and the right side's motors [A], and their power [W].

        Args:
            sums: MuJoCo's sensor values, summed over the steps of one tick, shape (sensors,).
        """
        steps = self._simulation.steps_per_tick
        torque = sums[self._torques] / steps
        work = self._sides @ (torque * sums[self._speeds] / steps)
        currents = np.where(work >= 0.0, np.abs(self._sides @ torque) / self._motor.motor_constant, 0.0)
        losses = self._motor.resistance * currents**2 / self._count
        return currents, float(np.maximum(work + losses, 0.0).sum())
