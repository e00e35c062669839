"""`--help` of every program: each option is explained, and its default is told."""

import argparse
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from harness import robot
from harness.cli import programs
from harness.course import __main__ as course
from harness.gym import policy
from tests.support.programs import PARSERS


def commands_of(program: str, parser: argparse.ArgumentParser) -> dict[str, argparse.ArgumentParser]:
    """The parsers of a program's commands."""
    (commands,) = (a for a in parser._actions if isinstance(a, argparse._SubParsersAction))
    return {f"{program} {name}": own for name, own in commands.choices.items()}


MANY = {
    "harness.robot": robot._parser(),
    "harness.course": course._parser(),
    "harness.gym.policy": policy._parser(),
}
COMMANDS = {
    name: lambda own=own: own
    for program, parser in MANY.items()
    for name, own in commands_of(program, parser).items()
}
PROGRAMS: dict[str, Callable[[], argparse.ArgumentParser]] = {**PARSERS, **COMMANDS}
PROGRAMS = {name: parser for name, parser in PROGRAMS.items() if name not in MANY}
WITHOUT = {
    "recording",  # what does nothing unless it is given, or must be
    *("terrain_size", "terrain_height", "fault", "namespace", "wait_for", "record", "summary"),
    *("wait_for_topic", "runs", "latex", "plot"),
    *("picture", "video", "address", "realism", "bag", "params", "remap", "logs", "versus", "value"),
    *("name", "source", "left", "right", "rover", "page", "actor", "goal_area", "paths", "file", "goal"),
    *("seeds", "seed", "only", "junit", "csv", "json", "out", "entry", "track", "nonce"),
    *("receipt", "folder", "config", "words", "recording"),
}


LATE = {  # what takes long to load, and no help needs
    *("mujoco", "numba", "scipy.linalg", "scipy.fft", "scipy.spatial", "scipy.ndimage", "scipy.stats"),
    *("pandas", "matplotlib", "PIL", "trimesh", "jinja2", "joblib", "torch", "sklearn", "rclpy"),
}

SIMULATES = {"mujoco", "numba"}
OF_FILES = {"tifffile", "pymap3d", "mcap", "rosbags"}  # of worlds, recordings

ASKING = """
import os, sys
from harness.cli import programs
asked = [*([verb, "--help"] for verb in programs.PROGRAMS), ["run", "--list"]]
if os.fork() == 0:
    asked = [["run", "--direct", "--terrain", "flat", "--duration", "0.05", "--log-dir", sys.argv[1]]]
else:
    os.wait()
for words in asked:
    sys.argv = ["rover", *words]
    try:
        code = programs.rover()
    except SystemExit as left:
        code = left.code
    print("_".join(words[:2]), code, *sys.modules, file=sys.stderr)
"""


def test_helps_lists_and_a_run_on_a_terrain_of_a_name_load_nothing_that_they_do_not_need(
    tmp_path: Path,
) -> None:
    asking = [sys.executable, "-c", ASKING, str(tmp_path)]
    run = subprocess.run(asking, capture_output=True, text=True, check=True)
    asked = [line.split() for line in run.stderr.splitlines() if " " in line]
    wanted = [*(f"{verb}_--help" for verb in programs.PROGRAMS), "run_--list", "run_--direct"]
    assert {words: code for words, code, *_ in asked} == dict.fromkeys(wanted, "0")
    assert all(f"usage: rover {verb} " in run.stdout for verb in programs.PROGRAMS)
    driven, *helps = asked
    late = {words: LATE & set(loaded) for words, _, *loaded in helps}
    assert not any(late.values()), late
    assert not (needless := (LATE - SIMULATES | OF_FILES) & set(driven)), needless


@pytest.mark.parametrize("program", PROGRAMS)
def test_help_explains_each_option_and_tells_its_default(program: str) -> None:
    parser = PROGRAMS[program]()
    formatter = parser._get_formatter()
    for action in parser._actions:
        assert action.help, f"{program} {action.dest} is not explained"
        told = formatter._expand_help(action)
        if action.nargs != 0 and action.dest not in WITHOUT:
            assert "default" in told, f"{program} {action.dest}: {told}"
