"""Drivers by name: what chooses the commands of an episode."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

from harness.base.errors import find_named
from harness.drivers.base import OF_POLICY, Driver, TakesGoals
from rover_metrics.plugins import Shipped, Table

OF_A_DRIVER = ("summary", "senses", "command")
SHIPPED = Shipped[type[Driver]](
    "harness.drivers",
    {
        "wander": ".wander:Wander",
        "straight": ".scripted:Straight",
        "spin": ".scripted:Spin",
        "figure8": ".scripted:Figure8",
        "cmd_vel": ".scripted:CmdVel",
        "goal": ".goal:Goal",
        "beeline": ".beeline:Beeline",
        "gap": ".gap:Gap",
        "dwa": ".dwa:Dwa",
        "mppi": ".mppi:Mppi",
        "roam": ".wander:Roam",
        "ram": ".encounters:Ram",
        "reverse_into": ".encounters:ReverseInto",
        "graze": ".encounters:Graze",
        "swing": ".encounters:Swing",
        "pass_by": ".encounters:PassBy",
    },
)


def _is_driver(value: Any) -> bool:  # noqa: ANN401 - whatever a plug-in is
    if not isinstance(value, type) or not all(hasattr(value, name) for name in OF_A_DRIVER):
        return False
    senses, command = getattr(value, "senses", None), getattr(value, "command", None)
    if not (isinstance(senses, Collection) and callable(command)):
        return False
    return all(isinstance(kind, type) for kind in senses)


DRIVERS = Table[type[Driver]](
    "drivers",
    SHIPPED,
    _is_driver,
    f"a class with {', '.join(OF_A_DRIVER)} (senses: types of samples), as harness.drivers.base.Driver",
)


def find_driver(name: str) -> type[Driver]:
    """Returns the driver of that name, or of `policy:FILE` or `FILE.py:CLASS`, else UsageError."""
    if name.startswith(OF_POLICY):
        from harness.drivers.policy import driver_of, read_policy  # noqa: PLC0415 - few have one

        file = Path(name.removeprefix(OF_POLICY))
        read_policy(file)
        return driver_of(file)
    return find_named("driver", name, DRIVERS)


def takes_goals(name: str) -> bool:
    """Returns whether the driver of that name takes goals; UsageError if there is none."""
    return issubclass(find_driver(name), TakesGoals)


def goal_takers() -> str:
    """Returns the names of the drivers that take goals, for a message."""
    return ", ".join([*(name for name in SHIPPED if takes_goals(name)), f"{OF_POLICY}FILE"])
