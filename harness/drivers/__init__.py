"""Drivers by name: what chooses the commands of an episode."""

from harness.drivers.base import Driver, DriverContext, Observation
from harness.drivers.encounters import Graze, PassBy, Ram, ReverseInto, Swing
from harness.drivers.goal import Goal
from harness.drivers.scripted import CmdVel, Figure8, Spin, Straight
from harness.drivers.wander import Roam, Wander
from harness.errors import find_named

__all__ = [
    "DRIVERS",
    "LOOKING",
    "CmdVel",
    "Driver",
    "DriverContext",
    "Goal",
    "Observation",
    "find_driver",
]

DRIVERS: dict[str, type[Driver]] = {
    "wander": Wander,
    "straight": Straight,
    "spin": Spin,
    "figure8": Figure8,
    "cmd_vel": CmdVel,
    "goal": Goal,
    "roam": Roam,
    "ram": Ram,
    "reverse_into": ReverseInto,
    "graze": Graze,
    "swing": Swing,
    "pass_by": PassBy,
}
LOOKING = ("wander", "roam")  # those that use scans


def find_driver(name: str) -> type[Driver]:
    """Returns the driver of that name.

    Raises:
        UsageError: No such driver; the message names those there are.
    """
    return find_named("driver", name, DRIVERS)
