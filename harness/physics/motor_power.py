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
        is_on = [[name in side for name in drive.driven] for side in (drive.left, drive.right)]
        sides, tied = np.array(is_on, float), self._motor.one_motor_a_side
        self._of_motor = sides if tied else np.eye(len(drive.driven))  # from wheels
        self._of_side = np.eye(2) if tied else sides  # from motors

    def draw(self, sums: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Returns the current of the left and the right side's motors [A], and their power [W].

        Args:
            sums: MuJoCo's sensor values, summed over the steps of one tick, shape (sensors,).
        """
        steps = self._simulation.steps_per_tick
        torque = sums[self._torques] / steps
        work = self._of_motor @ (torque * sums[self._speeds] / steps)
        drawn = np.abs(self._of_motor @ torque) / self._motor.motor_constant
        currents = np.where(work >= 0.0, drawn, 0.0)
        power = np.maximum(work + self._motor.resistance * currents**2, 0.0)
        return self._of_side @ currents, float(power.sum())
