"""Drivers by name: what chooses the commands of an episode."""

from functools import partial
from pathlib import Path

from harness.base.errors import find_named
from harness.drivers.base import Driver, DriverContext, Observation, TakesGoals
from harness.drivers.beeline import Beeline
from harness.drivers.dwa import Dwa
from harness.drivers.encounters import Graze, PassBy, Ram, ReverseInto, Swing
from harness.drivers.from_file import PREFIX as IN_FILE
from harness.drivers.from_file import driver_in
from harness.drivers.gap import Gap
from harness.drivers.goal import Goal
from harness.drivers.mppi import Mppi
from harness.drivers.policy import PREFIX, PolicyDriver, driver_of, read_policy
from harness.drivers.scripted import CmdVel, Figure8, Spin, Straight
from harness.drivers.wander import Roam, Wander
from harness.samples import Sample
from rover_metrics.plugins import Table

__all__ = [
    "DRIVERS",
    "CmdVel",
    "Driver",
    "DriverContext",
    "Goal",
    "Observation",
    "PolicyDriver",
    "TakesGoals",
    "find_driver",
    "sensed_by",
    "takes_goals",
]

OF_A_DRIVER = ("summary", "senses", "command")
SHIPPED: dict[str, type[Driver]] = {
    "wander": Wander,
    "straight": Straight,
    "spin": Spin,
    "figure8": Figure8,
    "cmd_vel": CmdVel,
    "goal": Goal,
    "beeline": Beeline,
    "gap": Gap,
    "dwa": Dwa,
    "mppi": Mppi,
    "roam": Roam,
    "ram": Ram,
    "reverse_into": ReverseInto,
    "graze": Graze,
    "swing": Swing,
    "pass_by": PassBy,
}
DRIVERS = Table[type[Driver]](
    "drivers",
    SHIPPED,
    lambda value: isinstance(value, type) and all(map(partial(hasattr, value), OF_A_DRIVER)),
    f"a class with {', '.join(OF_A_DRIVER)}, as harness.drivers.base.Driver",
)


def find_driver(name: str) -> type[Driver]:
    """Returns the driver of that name, or of `policy:FILE` or `python:FILE:CLASS`, else UsageError."""
    if name.startswith(PREFIX):
        file = Path(name.removeprefix(PREFIX))
        read_policy(file)
        return driver_of(file)
    if name.startswith(IN_FILE):
        return driver_in(name)
    return find_named("driver", name, DRIVERS)


def takes_goals(name: str) -> bool:
    """Returns whether the driver of that name goes to goals that it is given; UsageError without it."""
    return issubclass(find_driver(name), TakesGoals)


def sensed_by(name: str) -> frozenset[type[Sample]]:
    """Returns the samples that the driver of that name looks at; UsageError without it."""
    return find_driver(name).senses
