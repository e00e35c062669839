"""The controller of a rover's base, by its kind of drive."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from harness.physics.ackermann import Ackermann
from harness.physics.diff_drive import DiffDrive
from harness.robots import RoverSpec
from harness.samples import Twist


class BaseController(Protocol):
    """What makes wheel commands of a twist."""

    def command(self, twist: Twist) -> bool:
        """Latches a command; returns whether it was valid."""

    def wheel_speeds(self) -> NDArray[np.float64]:
        """Returns what `Simulation.command_wheels` takes, once per period."""


def base_controller(rover: RoverSpec, period: float) -> BaseController:
    """Returns the controller of a rover.

    Args:
        rover: Whose drive says which.
        period: From one call of `wheel_speeds` to the next [s].
    """
    return Ackermann(rover, period) if rover.steers else DiffDrive(rover, period)
