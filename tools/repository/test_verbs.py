"""The two commands of the README."""

import os
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    ("verb", "does"), [("run", "-m harness.run --terrain rocky"), ("test", "-m pytest")]
)
def test_verb_of_the_readme_sets_everything_up_and_then_does_its_work(verb: str, does: str) -> None:
    assert f"make {verb} " in (ROOT / "README.md").read_text()
    planned = subprocess.run(
        ["make", "--dry-run", "--always-make", verb],  # noqa: S607 - the user's make
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    assert -1 < planned.find("tools/setup.sh") < planned.find(does)


def test_set_up_names_the_python_that_it_was_given(tmp_path: Path) -> None:
    old = tmp_path / "python3.10"
    old.write_text('#!/bin/sh\n[ "$1" = --version ] && echo Python 3.10.13\n')
    old.chmod(0o755)
    command = [ROOT / "tools/setup.sh"]
    run = subprocess.run(
        command, env=os.environ | {"PYTHON": str(old)}, capture_output=True, text=True, check=False
    )
    assert run.returncode == 2
    first = run.stderr.splitlines()[0]
    assert first == f"setup: needs Python 3.11, 3.12 or 3.13, found Python 3.10.13 ({old})."


def test_setup_compiles_kernels_that_there_are() -> None:
    listed = re.findall(r'kernels="(?:\$kernels )?([\w. ]+)"', (ROOT / "tools/setup.sh").read_text())
    for name in " ".join(listed).split():
        text = (ROOT / "harness" / f"{name.replace('.', '/')}.py").read_text()
        assert "from harness.base.compiled import" in text, name
