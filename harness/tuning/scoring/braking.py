"""How far a rover drives on before it stands: measured on level ground, from its top speed."""

from dataclasses import dataclass

from harness.drivers.base import CONTROL_PERIOD
from harness.robots import RoverSpec
from harness.validation.driving import straight_speed
from harness.validation.grounds import floor
from harness.validation.rig import Rig

SCAN_PERIOD = 0.05  # [s]
LATENCY = SCAN_PERIOD + CONTROL_PERIOD  # [s] from what is there to a command that answers it, at worst
STANDSTILL, LONGEST_STOP = 0.01, 5.0  # [m/s], [s]


@dataclass(frozen=True, slots=True)
class Braking:
    """A stop from top speed.

    Attributes:
        speed: Top speed, measured [m/s].
        distance: From the command to the standstill [m].
        time: Likewise [s].
    """

    speed: float
    distance: float
    time: float

    @property
    def stopping_distance(self) -> float:
        """With what is driven before the command comes [m]."""
        return self.speed * LATENCY + self.distance

    def needed_lead(self, speed: float) -> float:
        """How long before a contact at constant speed the warning must come [s].

        The stopping distance over the speed: deceleration is constant, so braking from a lower speed
        takes less time in proportion, and half the way of driving on.
        """
        return LATENCY + self.time * min(1.0, speed / self.speed) / 2


def measure_braking(rover: RoverSpec, seed: int) -> Braking:
    """Drives up to top speed on a level floor and stops."""
    rig = Rig(rover, floor(seed))
    # More than the wheels can do would have to be unwound first.
    speed = straight_speed(rig, rover.wheel_speed_limit * rover.controller_radius)
    start, began = rig.stance.ahead, rig.simulation.time_ns
    rig.command(0.0)
    rig.run_until(lambda: rig.speed < STANDSTILL, LONGEST_STOP)
    seconds = (rig.simulation.time_ns - began) / 1e9
    return Braking(speed, rig.stance.ahead - start, seconds)
