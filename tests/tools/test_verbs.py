"""The two commands of the README."""

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
