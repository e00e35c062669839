"""The commands as pip installs them, beside `python -m`."""

import ast
import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
import tomllib

from harness.cli import programs

ROOT = Path(__file__).parents[3]
SCRIPTS: dict[str, str] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
OURS = {name: place for name, place in SCRIPTS.items() if name.startswith("rover-")}
# Nobody's daily work: they write what is kept in this repository, or are the inside of another.
WITHOUT = {
    "harness.gym.policy_node",
    "harness.scenario.schema",
    "harness.view.picture",
    "rover_metrics.__main__",
    "rover_metrics.dictionary",
    "rover_metrics.metrics_node",
}


def module_of(script: str) -> str:
    """Where the command of a script is, by what it would start."""
    place, _, name = OURS[script].partition(":")
    assert place == programs.__name__
    return programs.PROGRAMS[name].module


def runnable() -> set[str]:
    """Every module of both packages that is a program."""
    found = set()
    for top in (ROOT / "harness", ROOT / "rover_metrics/rover_metrics"):
        for path in top.rglob("*.py"):
            if '\nif __name__ == "__main__":' in path.read_text():
                found.add(".".join(path.relative_to(top.parent).with_suffix("").parts))
    return found


def test_each_program_has_a_script_or_needs_none() -> None:
    assert {module_of(script) for script in OURS} == runnable() - WITHOUT


@pytest.mark.parametrize("script", OURS)
def test_a_script_starts_its_module_under_its_own_name(
    script: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    begun: list[str] = []
    monkeypatch.setattr(programs, "begin_program", begun.append)
    monkeypatch.setattr(sys, "argv", [f"/somewhere/bin/{script}", "--help"])
    with pytest.raises(SystemExit) as left:
        getattr(programs, OURS[script].partition(":")[2])()
    assert left.value.code == 0
    assert capsys.readouterr().out.startswith(f"usage: {script} ")
    # Mistakes are told under the module's name, whichever way it was called.
    source = Path(str(importlib.import_module(module_of(script)).__file__)).read_text()
    assert re.search(rf'(begin|run)_program\("{re.escape(begun[0])}"', source)


def test_every_command_has_a_script() -> None:
    assert {f"rover-{verb}" for verb in programs.PROGRAMS} == OURS.keys()


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("rover-call --no-such-option", "rover-call: unrecognized arguments: --no-such-option;"),
        ("rover call --no-such-option", "rover call: unrecognized arguments: --no-such-option;"),
        ("rover run --robot r2d2", "rover run: robot 'r2d2' does not exist; available: "),
        ("rover rnu", "rover: command 'rnu' does not exist; did you mean 'run'?"),
    ],
)
def test_a_mistake_is_told_under_the_name_that_was_typed(
    typed: str, told: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(programs, "begin_program", lambda _: None)
    monkeypatch.setattr(sys, "argv", typed.split())
    try:
        code: object = programs.call() if typed.startswith("rover-") else programs.rover()
    except SystemExit as left:
        code = left.code
    assert code == 2
    assert capsys.readouterr().err.startswith(told)


def test_help_is_asked_for_with_and_without_dashes(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = list[str]()
    for word in ("--help", "help"):
        monkeypatch.setattr(sys, "argv", ["rover", word])
        with pytest.raises(SystemExit) as left:
            programs.rover()
        assert left.value.code == 0
        asked.append(capsys.readouterr().out)
    assert asked[0] == asked[1]


def completed(line: str) -> list[str]:
    """What a shell is offered for a line, as argcomplete's shell code asks for it."""
    surroundings = {"COMP_LINE": line, "COMP_POINT": str(len(line)), "_ARGCOMPLETE": "1"}
    more = {"COMP_TYPE": "9", "_ARGCOMPLETE_IFS": "\n", "_ARGCOMPLETE_STDOUT_FILENAME": "/dev/stdout"}
    words = [sys.executable, "-c", "from harness.cli.programs import rover; rover()"]
    told = subprocess.run(
        words, env=os.environ | surroundings | more, stdout=subprocess.PIPE, check=True
    )
    return told.stdout.decode().split("\n")


def test_a_shell_completes_commands_and_their_options() -> None:
    assert [word.strip() for word in completed("rover va")] == ["validate"]
    assert "--terrain" in completed("rover run --te")
    assert set(completed("rover run --odom-tf ")) == {"ground_truth", "wheels", "none"}


def test_nothing_is_loaded_before_a_program_is_ready() -> None:
    tree = ast.parse(Path(programs.__file__).read_text())
    loaded = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert loaded - {"functools", "typing", "argcomplete.shell_integration"} == {
        *("harness.base.version", "harness.base.edge"),
        *("rover_metrics.errors", "rover_metrics.parser"),
    }
