import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("command", ["run", "tune", "check", "validate", "topics", "call"])
def test_in_a_python_without_the_project_each_command_says_which_one_has_it(command: str) -> None:
    words = [sys.executable, "-ES", "-m", f"harness.{command}"]  # nothing installed, no PYTHONPATH
    run = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (2, "")
    (line,) = run.stderr.splitlines()
    assert "rover-harness is not installed in this Python" in line
    assert f"{sys.executable}); use .venv/bin/python after make setup, or pip install" in line
