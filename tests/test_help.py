"""`--help` of every program: each option is explained, and its default is told."""

import argparse
from collections.abc import Callable

import pytest

from benchmarks import __main__ as benchmarks
from benchmarks.soak import __main__ as soak
from harness import call, check, robot, topics, tune, validate
from harness.cli.run_parser import run_parser
from rover_metrics import dictionary, social
from rover_metrics.analysis import options as analyze
from rover_metrics.bag import options as replay


def of_robot(command: str) -> argparse.ArgumentParser:
    """The parser of a command of harness.robot."""
    (commands,) = (a for a in robot._parser()._actions if isinstance(a, argparse._SubParsersAction))
    parser: argparse.ArgumentParser = commands.choices[command]
    return parser


PROGRAMS: dict[str, Callable[[], argparse.ArgumentParser]] = {
    "harness.run": run_parser,
    "harness.tune": tune._parser,
    "harness.check": check._parser,
    "harness.validate": validate._parser,
    "harness.robot new": lambda: of_robot("new"),
    "harness.robot check": lambda: of_robot("check"),
    "harness.topics": topics._parser,
    "harness.call": call._parser,
    "rover_metrics.analyze": analyze._parser,
    "rover_metrics.social": social._parser,
    "rover_metrics.replay": replay.parser,
    "rover_metrics.dictionary": dictionary._parser,
    "benchmarks": benchmarks._parser,
    "benchmarks.soak": soak._parser,
}
WITHOUT = {  # what does nothing unless it is given, or must be
    *("terrain_size", "terrain_height", "fault", "namespace", "wait_for", "record", "report", "summary"),
    *("picture", "video", "address", "realism", "bag", "params", "remap", "logs", "versus", "value"),
    *("name", "source", "left", "right", "rover", "page", "actor", "goal_area"),
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
