"""CONTRIBUTING's map of the house names every folder, and every module at the two roots."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGES = {"harness": 14, "rover_metrics/rover_metrics": 12}  # modules at the root, at most


def the_map() -> str:
    text = (ROOT / "CONTRIBUTING.md").read_text()
    return text.split("```")[1]


def tracked() -> list[Path]:
    listed = subprocess.run(
        ["git", "ls-files"],  # noqa: S607 - the developer's git
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("not a git checkout: what belongs to the project is not known")
    return [Path(line) for line in listed.stdout.splitlines()]


def modules_at(package: str) -> set[str]:
    found = {path.name for path in tracked() if path.parent == Path(package) and path.suffix == ".py"}
    return {name for name in found if not name.startswith("__")}


@pytest.mark.parametrize("package", PACKAGES)
def test_the_map_names_every_module_and_folder_of_a_package(package: str) -> None:
    folders = {
        f"{path.relative_to(package).parts[0]}/"
        for path in tracked()
        if path.is_relative_to(package) and len(path.relative_to(package).parts) > 1
    }
    named = set(re.findall(r"[\w]+(?:\.py|/)", the_map()))
    assert modules_at(package) | folders <= named


def test_the_map_names_every_folder_at_the_top() -> None:
    folders = {f"{path.parts[0]}/" for path in tracked() if len(path.parts) > 1}
    assert {name for name in folders if not name.startswith(".")} <= set(
        re.findall(r"^([\w]+/)", the_map(), re.MULTILINE)
    )


@pytest.mark.parametrize("package", PACKAGES)
def test_the_map_names_nothing_that_is_not_there(package: str) -> None:
    modules = set(re.findall(r"\b(\w+\.py)\b", the_map()))
    everywhere = {path.name for path in tracked()}
    assert modules <= everywhere
    assert len(modules_at(package)) <= PACKAGES[package]
