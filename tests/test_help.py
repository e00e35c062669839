"""`--help` of every program: each option is explained, and its default is told."""

import argparse
from collections.abc import Callable

import pytest

from harness import robot
from tests.support.programs import PARSERS


def of_robot(command: str) -> argparse.ArgumentParser:
    """The parser of a command of harness.robot."""
    (commands,) = (a for a in robot._parser()._actions if isinstance(a, argparse._SubParsersAction))
    parser: argparse.ArgumentParser = commands.choices[command]
    return parser


COMMANDS = {f"harness.robot {name}": lambda name=name: of_robot(name) for name in ("new", "check")}
PROGRAMS: dict[str, Callable[[], argparse.ArgumentParser]] = {**PARSERS, **COMMANDS}
del PROGRAMS["harness.robot"]  # has commands, no options
WITHOUT = {  # what does nothing unless it is given, or must be
    *("terrain_size", "terrain_height", "fault", "namespace", "wait_for", "record", "summary"),
    *("picture", "video", "address", "realism", "bag", "params", "remap", "logs", "versus", "value"),
    *("name", "source", "left", "right", "rover", "page", "actor", "goal_area", "paths", "file", "goal"),
    *("seeds", "seed", "only", "junit", "csv", "json", "out"),
}


@pytest.mark.parametrize("program", PROGRAMS)
def test_help_explains_each_option_and_tells_its_default(program: str) -> None:
    parser = PROGRAMS[program]()
    formatter = parser._get_formatter()
    for action in parser._actions:
        assert action.help, f"{program} {action.dest} is not explained"
        told = formatter._expand_help(action)
        if action.nargs != 0 and action.dest not in WITHOUT:
            assert "default" in told, f"{program} {action.dest}: {told}"
