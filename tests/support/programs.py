"""The parser of each program, by the module that `python -m` takes."""

import argparse
from collections.abc import Callable

from benchmarks import __main__ as benchmarks
from benchmarks.soak import __main__ as soak
from harness import call, check, play, robot, teleop, topics
from harness.cli import programs
from harness.cli.run_parser import run_parser
from harness.course import __main__ as course
from harness.fit import __main__ as fit
from harness.gym import policy, policy_node
from harness.scenario import __main__ as scenario
from harness.tune import __main__ as tune
from harness.validate import __main__ as validate
from rover_metrics import dictionary, replay, social
from rover_metrics.analysis import options as analyze

PARSERS: dict[str, Callable[[], argparse.ArgumentParser]] = {
    "harness.run": run_parser,
    "harness.tune": tune._parser,
    "harness.check": check._parser,
    "harness.play": play._parser,
    "harness.validate": validate._parser,
    "harness.fit": fit._parser,
    "harness.robot": robot._parser,
    "harness.scenario": scenario._parser,
    "harness.course": course._parser,
    "harness.gym.policy": policy._parser,
    "harness.gym.policy_node": policy_node._parser,
    "harness.topics": topics._parser,
    "harness.call": call._parser,
    "harness.teleop": teleop._parser,
    "rover_metrics.analyze": analyze._parser,
    "rover_metrics.social": social._parser,
    "rover_metrics.replay": replay.parser,
    "rover_metrics.dictionary": dictionary._parser,
    "benchmarks": benchmarks._parser,
    "benchmarks.soak": soak._parser,
}


def module_of(words: list[str]) -> tuple[str, list[str]]:
    """Returns the module that a command runs, and its arguments; "" for what is no program of ours."""
    if words[:2] == ["python", "-m"]:
        return words[2], words[3:]
    if words[0].startswith("rover-"):
        words = ["rover", words[0].removeprefix("rover-"), *words[1:]]
    if words[0] == "rover" and words[1] in programs.PROGRAMS:
        return programs.PROGRAMS[words[1]].module.removesuffix(".__main__"), words[2:]
    return "", words
