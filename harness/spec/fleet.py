"""Several rovers in one world, as `--rover` says it: a setup each.

They share the world, its people and its time; each has a name, which is its namespace and its folder of
logs, a start, a driver, sensors and faults of its own. The first one is the rover of a single run.
"""

from collections.abc import Sequence
from typing import Any

from harness.base.errors import UsageError
from harness.base.ros_names import NAME, NAMES
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.value import made
from rover_metrics.errors import shown

FORM = "ROBOT[:NAME][,KEY=VALUE]..."
PLACE, WORDS = ("x", "y", "yaw"), ("driver", "noise", "actuators", "surface")
KEYS = (*PLACE, *WORDS, "sensors", "fault")
CLOCK = "clock"  # of which there is one for all


def parse_rovers(texts: Sequence[str], shared: RoverSetup) -> tuple[RoverSetup, ...]:
    """Returns the setups of rovers.

    Args:
        texts: One per rover, of the form FORM; sensors are separated by +, `fault` may be repeated.
        shared: What holds for all of them; its start is the first one's, and the time-out of its
            commands that of those which obey commands.

    Raises:
        UsageError: One is not valid.
    """
    rovers = tuple(_parsed(text, number, shared) for number, text in enumerate(texts))
    if any(rover.driver == CMD_VEL for rover in rovers):
        return tuple(r if r.driver == CMD_VEL else r.but(cmd_vel_timeout=None) for r in rovers)
    return rovers


def _parsed(text: str, number: int, shared: RoverSetup) -> RoverSetup:
    head, *pairs = text.split(",")
    robot, colon, name = head.rpartition(":")
    robot, name = (robot, name) if colon else (head, f"rover{number + 1}")
    if not NAME.fullmatch(name):
        raise UsageError(f"--rover {shown(text)}: '{shown(name)}' is no name in ROS; {NAMES}")
    given: dict[str, Any] = {"start": shared.start if number == 0 else None}
    place: dict[str, str] = {}
    faults: list[str] = []
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or key not in KEYS:
            raise UsageError(
                f"--rover {text}: '{pair}' is not known; available: {', '.join(KEYS)}=VALUE"
            )
        if key in PLACE:
            place[key] = value
        elif key == "fault":
            faults.append(value)
        else:
            given[key] = value.split("+") if key == "sensors" else value
    if place:
        if not {"x", "y"} <= place.keys():
            raise UsageError(f"--rover {text}: a start needs x and y; give both, in metres")
        given["start"] = (place["x"], place["y"], place.get("yaw", 0.0))
    rover = made(RoverSetup, shared.__dict__ | {"robot": robot, "name": name} | given, f"--rover {text}")
    own = made(RoverSetup, {"faults": faults}, f"--rover {text}").faults
    if any(fault.sensor == CLOCK for fault in own):
        raise UsageError(f"--rover {text}: there is one clock for all; give its faults as --fault")
    return rover.but(faults=(*shared.faults, *own))
