"""Each command and block of code of README and site is run, or parsed for a reason that is told."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from harness import run
from harness.scenario import __main__ as scenario
from harness.scenario.reading import read_scenario
from rover_metrics.extended.parameter_file import read_values
from tests.support.documents import PAGES, ROOT, blocks, commands
from tests.support.programs import PARSERS, module_of

RUN_HERE = ("docs/your_terrain.md", "docs/train.md")  # shortened, and what needs no ROS
RUN = {"harness.run": run.main, "harness.scenario": scenario.main}
PYTHON_ELSEWHERE = {  # the test that runs the code of a page, or why none does
    "docs/api.md": "tests/test_api.py runs it",
    "docs/extend.md": "tests/harness/test_plugins.py runs the like of it",
    "docs/gym.md": "tests/harness/gym/test_env.py runs it",
    "docs/testing.md": "a part of examples/test_emergency_stop.py, which tests/harness/testing runs",
    "docs/log.md": "tests/harness/view/live/test_page.py does the same with a run's own manifest",
    "docs/scenarios.md": "MyNode is the reader's; tests/harness/scenario has the like",
}
# Our own commands elsewhere are parsed only: they drive through ROS or for minutes, need the reader's
# files, and have tests of their own. What is not ours:
NOT_OURS = {
    "make": "tests/tools/test_verbs.py; the verb is looked up here",
    "pytest": "the path is looked up here",
    "python": "a file of examples/, which is looked up here; a program of Python's own: venv, pip",
    "pip": "the extras are looked up here",
    "rover": "tests/harness/cli/test_programs.py, without a command",
    "my_node": "the reader's",
    "metrics_node": "tests/rover_metrics/test_metrics_program.py",
    **dict.fromkeys(
        ("ros2", "colcon", "plotjuggler", "podman", "node", "cargo", "npm"), "need not be installed"
    ),
    **dict.fromkeys(("source", ".", "export"), "of the shell"),
}


@pytest.mark.parametrize("page", PAGES)
def test_a_command_of_a_page_is_understood(page: str) -> None:
    verbs = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE))
    extras = set(re.findall(r"^(\w+) = \[", (ROOT / "pyproject.toml").read_text(), re.MULTILINE))
    for block in blocks(page, "sh", "bash"):
        for words in commands(block.text, seed="1"):
            module, arguments = module_of(words)
            if module in PARSERS:
                ours = arguments[: (*arguments, "--ros-args").index("--ros-args")]
                if not {"--help", "--list"} & set(ours):
                    PARSERS[module]().parse_args(ours)
                continue
            assert words[0] in NOT_OURS, f"{page}: {words}"
            assert words[0] != "make" or words[1] in verbs, words
            files = [
                word for word in words[1:2] if word.startswith(("examples/", "tests/", "scenarios/"))
            ]
            assert all((ROOT / name).exists() for name in files), words
            assert {e for w in words for e in re.findall(r"^(?:\.|rover-harness)\[(\w+)\]", w)} <= extras


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "python")])
def test_the_python_of_a_page_is_run_somewhere(page: str) -> None:
    assert (page in RUN_HERE) != (page in PYTHON_ELSEWHERE)
    for block in blocks(page, "python"):
        compile(block.text, page, "exec")
    if page == "docs/testing.md":
        example = " ".join((ROOT / "examples/test_emergency_stop.py").read_text().split())
        for line in blocks(page, "python")[0].text.splitlines():
            if "faults=" not in line and "def " not in line and "Run" not in line:
                assert line.strip(" )") in example


def parts_of(block: Any, whole: Any) -> bool:  # noqa: ANN401 - of YAML
    """Whether every key of a tree is in another, with the same value at its end."""
    if isinstance(block, dict) and isinstance(whole, dict):
        return all(key in whole and parts_of(value, whole[key]) for key, value in block.items())
    return bool(block == whole)


@pytest.mark.parametrize("page", [page for page in PAGES if blocks(page, "yaml")])
def test_yaml_of_a_page_is_valid_and_says_what_the_file_says_that_it_names(
    page: str, tmp_path: Path
) -> None:
    for block in blocks(page, "yaml"):
        content = YAML(typ="safe").load(block.text)
        (name, *_) = re.findall(r"\A# ([\w/.]+\.yaml)$", block.text, re.MULTILINE) or [""]
        if name and (ROOT / name).is_file():
            assert parts_of(content, YAML(typ="safe").load((ROOT / name).read_text())), name
        file = tmp_path / "a.scenario.yaml"
        file.write_text(block.text)
        if "about" in content:
            read_scenario(file)
        if "/**" in content:
            assert read_values(file)


def shortened(text: str) -> str:
    """A tutorial's block that drives for a second instead of a minute."""
    return re.sub(r"--duration \d+", "--duration 1", text.replace("duration: 30", "duration: 8"))


@pytest.mark.parametrize("page", RUN_HERE)
def test_a_tutorial_does_what_it_says(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("examples").mkdir()
    shutil.copy(ROOT / "examples/point_nav.npz", "examples")
    ran = []
    for block in blocks(page, "python", "yaml", "sh"):
        if block.language == "python":
            exec(block.text, {})  # noqa: S102 - ours
        elif block.language == "yaml":
            file = Path(block.text.split()[1])
            file.parent.mkdir(exist_ok=True)
            file.write_text(shortened(block.text))
        else:
            for words in commands(shortened(block.text)):
                module, arguments = module_of(words)
                if (
                    main := RUN.get(module)
                    if "--direct" in words or module == "harness.scenario"
                    else None
                ):
                    more = ["--jobs", "1"] if module == "harness.scenario" else []
                    assert main([*arguments, *more]) == 0, words
                    ran.append(words[0])
    assert "rover-scenario" in ran
