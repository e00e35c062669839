"""Several rovers in one world: what `--rover` says -> a configuration each.

They share the world, its people and its time; each has a name, which is its namespace and its folder of
logs, a start, a driver, sensors and faults of its own. The first one is the rover of a single run.
"""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from harness.base.errors import UsageError
from harness.config import CMD_VEL, EpisodeConfig
from harness.drivers import takes_goals
from harness.faults.clock import CLOCK
from harness.robots import find_rover, robot_name
from harness.world.berths import Member, berth
from harness.world.world import Start, World, starting_at

MOST_ROVERS = 16
FORM = "ROBOT[:NAME][,KEY=VALUE]..."
NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
NUMBERS, WORDS, LISTS = ("x", "y", "yaw"), ("driver", "noise"), {"sensors": "sensors", "fault": "faults"}
KEYS = (*NUMBERS, *WORDS, *LISTS)


def fleet_of_words(words: Sequence[str], shared: EpisodeConfig) -> tuple[EpisodeConfig, ...]:
    """Returns the configurations of rovers, all with a start but the first.

    Args:
        words: One a rover, of the form FORM; sensors are separated by +, `fault` may be repeated.
        shared: What holds for all of them; its start is the first one's.

    Raises:
        UsageError: One is not valid, two have the same name, or there is no room for all.
    """
    if len(words) > MOST_ROVERS:
        raise UsageError(f"{len(words)} rovers are too many for a world; give {MOST_ROVERS} at most")
    fleet = tuple(_parsed(text, number, shared) for number, text in enumerate(words))
    names = [config.name for config in fleet]
    for number, name in enumerate(names):
        if name in names[:number]:
            raise UsageError(f"two rovers are called '{name}'; give each a name of its own: ROBOT:NAME")
    fleet = tuple(replace(config, world_robot=fleet[0].robot) for config in fleet)
    if any(takes_goals(config.driver) for config in fleet):
        fleet = tuple(c if takes_goals(c.driver) else replace(c, goal_area=None) for c in fleet)
    if any(config.driver == CMD_VEL for config in fleet):
        fleet = tuple(c if c.driver == CMD_VEL else replace(c, cmd_vel_timeout=None) for c in fleet)
    for config in fleet:
        config.validate()
    return _placed(fleet)


def scenery(
    fleet: Sequence[EpisodeConfig], world: World | None = None
) -> tuple[World, tuple[Member, ...]]:
    """Returns the world of the first rover, and who starts where in it.

    Args:
        fleet: A configuration of each rover.
        world: That world, if it has been built already.

    Raises:
        UsageError: A value is not valid.
    """
    for config in fleet:
        config.validate()
    world = fleet[0].world() if world is None else world
    starts = [world.start if c.start is None else starting_at(world, c.start).start for c in fleet]
    return world, tuple(
        Member(config.name, find_rover(config.robot), start)
        for config, start in zip(fleet, starts, strict=True)
    )


def _parsed(text: str, number: int, shared: EpisodeConfig) -> EpisodeConfig:
    head, *pairs = text.split(",")
    robot, colon, name = head.rpartition(":")
    robot, name = (robot, name) if colon else (head, f"rover{number + 1}")
    find_rover(robot)
    if not NAME.fullmatch(name):
        raise UsageError(
            f"--rover {text}: '{name}' is no name in ROS; give letters, digits and _, a letter first"
        )
    given: dict[str, Any] = {"start": shared.start if number == 0 else None}
    place: dict[str, float] = {}
    for pair in pairs:
        key, equals, value = pair.partition("=")
        if not equals or key not in KEYS:
            raise UsageError(
                f"--rover {text}: '{pair}' is not known; available: {', '.join(KEYS)}=VALUE"
            )
        if key in NUMBERS:
            place[key] = _number(text, key, value)
        elif key in WORDS:
            given[key] = value
        else:
            before = given.get(LISTS[key], shared.faults if key == "fault" else ())
            given[LISTS[key]] = (*before, *(value.split("+") if key == "sensors" else (value,)))
    if place:
        if not {"x", "y"} <= place.keys():
            raise UsageError(f"--rover {text}: a start needs x and y; give both, in metres")
        given["start"] = place["x"], place["y"], place.get("yaw", 0.0)
    if any(fault.startswith(f"{CLOCK}:") for fault in given.get("faults", ())[len(shared.faults) :]):
        raise UsageError(f"--rover {text}: there is one clock for all; give its faults as --fault")
    return replace(shared, robot=robot, name=name, number=number, **given)


def _number(text: str, key: str, value: str) -> float:
    try:
        return float(value)
    except ValueError:
        message = f"--rover {text}: {key} '{value}' is no number; give metres, or radians for yaw"
        raise UsageError(message) from None


def _placed(fleet: tuple[EpisodeConfig, ...]) -> tuple[EpisodeConfig, ...]:
    """The fleet with a start for each but the first: beside the first one where none is given."""
    if all(config.start is not None for config in fleet[1:]):
        return fleet
    world = fleet[0].world()
    rovers = [find_rover(config.robot) for config in fleet]
    starts: list[Start | None] = [world.start, *(config.start for config in fleet[1:])]
    for number, rover in enumerate(rovers):
        if starts[number] is not None:
            continue
        taken = [
            (start[0], start[1], other.reach)
            for start, other in zip(starts, rovers, strict=True)
            if start is not None
        ]
        starts[number] = berth(world.start, rover, taken, world)
        if starts[number] is None:
            raise UsageError(
                f"there is no room for {fleet[number].name} near the start of {fleet[0].name}; "
                f"give it one: --rover {robot_name(fleet[number].robot)}:{fleet[number].name},x=X,y=Y"
            )
    return (
        fleet[0],
        *(replace(c, start=start) for c, start in zip(fleet[1:], starts[1:], strict=True)),
    )
