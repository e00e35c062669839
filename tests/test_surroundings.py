"""Whoever starts the suite: a part of it passes where nearly everything that is inherited is unusual."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

# Tests that signal, start programs, write files, and write numbers and dates.
PART = (
    "e2e/test_clean_ends.py::test_signal_ends_a_direct_run_even_if_it_is_much_slower_than_real_time",
    "harness/episode/test_result.py",
    "harness/test_run.py::test_direct_run_writes_csv_and_manifest",
    "rover_metrics/log/test_csv_log.py",
    "rover_metrics/test_metrics_program.py::test_a_signal_ends_the_program_cleanly_and_marks_the_end",
    "rover_metrics/log/test_session_record.py",
)
IGNORING = """trap '' HUP INT QUIT TERM PIPE; umask 077; exec "$@" """
UNUSUAL = {
    "LANG": "de_DE.UTF-8",
    "LC_NUMERIC": "de_DE.UTF-8",
    "LC_CTYPE": "C",
    "TZ": "Asia/Kathmandu",
    "HOME": "/proc/nobody",
    "TERM": "dumb",
    "COLUMNS": "20",
    "NO_COLOR": "1",
    "ROS_DOMAIN_ID": "232",
}


def without_the_powers_of_root() -> list[str]:
    """What starts a command that file permissions hold for, whoever starts it."""
    if os.geteuid() != 0:
        return []
    if shutil.which("setpriv") is None:
        pytest.skip("root without setpriv cannot put its powers aside")
    return ["setpriv", "--no-new-privs", "--inh-caps=-all", "--bounding-set=-all"]


def test_a_part_of_the_suite_passes_whoever_starts_it(tmp_path: Path) -> None:
    folder = tmp_path / "a folder with späces"
    folder.mkdir()
    options = ["-q", "-p", "no:cacheprovider", "-c", str(ROOT / "pyproject.toml")]
    tests = [str(ROOT / "tests" / part) for part in PART]
    command = [sys.executable, "-m", "pytest", *options, "--basetemp", str(folder / "temp"), *tests]
    done = subprocess.run(
        ["sh", "-c", IGNORING, "sh", *without_the_powers_of_root(), *command],  # noqa: S607 - any sh
        cwd=folder,
        env=os.environ | UNUSUAL | {"PYTHONPATH": os.pathsep.join((str(ROOT), *sys.path))},
        capture_output=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert {path.name for path in folder.iterdir()} <= {"temp"}, "files beside the tests' own folder"
