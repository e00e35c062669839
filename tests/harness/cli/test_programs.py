"""The commands as pip installs them, beside `python -m`."""

import ast
import importlib
import re
import sys
from functools import partial
from pathlib import Path

import pytest
import tomllib

from harness.cli import programs

ROOT = Path(__file__).parents[3]
SCRIPTS: dict[str, str] = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["scripts"]
OURS = {name: place for name, place in SCRIPTS.items() if name.startswith("rover-")}
# Nobody's daily work: they write what is kept in this repository, or are the inside of another.
WITHOUT = {
    "harness.scenario.schema",
    "harness.view.picture",
    "rover_metrics.__main__",
    "rover_metrics.dictionary",
    "rover_metrics.metrics_node",
}


def module_of(script: str) -> str:
    """Where the command of a script is, by what it would start."""
    place, _, name = OURS[script].partition(":")
    started = getattr(importlib.import_module(place), name)
    assert isinstance(started, partial)
    assert started.func is programs.start
    module: str = started.args[0]
    return module


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


def test_a_mistake_is_told_under_the_modules_name(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(programs, "begin_program", lambda _: None)
    monkeypatch.setattr(sys, "argv", ["rover-call", "--no-such-option"])
    with pytest.raises(SystemExit) as left:
        programs.call()
    assert left.value.code == 2
    assert capsys.readouterr().err.startswith("harness.call: unrecognized arguments: --no-such-option;")


def test_nothing_is_loaded_before_a_program_is_ready() -> None:
    tree = ast.parse(Path(programs.__file__).read_text())
    loaded = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert loaded == {"functools", "harness.cli.edge"}
