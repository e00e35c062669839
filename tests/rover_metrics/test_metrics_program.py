"""The program metrics_node: how it ends and what it says when it cannot start."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import rover_metrics

TIMEOUT = 30.0  # seconds; reached only when a test fails
PACKAGE = str(Path(rover_metrics.__file__).parents[1])
COMMAND = [sys.executable, "-m", "rover_metrics.metrics_node"]


def environment(*paths: str) -> dict[str, str]:
    domain = str(1 + os.getpid() % 101)
    return {**os.environ, "PYTHONPATH": os.pathsep.join([*paths, PACKAGE]), "ROS_DOMAIN_ID": domain}


def wait_for_a_row(log: Path) -> None:
    """Wait until the program spins; a signal before that may disturb its first message."""
    deadline = time.monotonic() + TIMEOUT
    while len(log.read_bytes().splitlines()) < 2:
        assert time.monotonic() < deadline, "no row"
        time.sleep(0.02)


@pytest.fixture
def _ros() -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")


def refused(tmp_path: Path, *args: str, env: dict[str, str] | None = None) -> str:
    """Run the program, which must refuse to start without a traceback; gives its last line."""
    run = subprocess.run(
        [*COMMAND, *args],
        cwd=tmp_path,
        env=env or environment(),
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=False,
    )
    assert run.returncode == 2, run.stderr
    assert "Traceback" not in run.stderr
    return run.stderr.splitlines()[-1]


@pytest.mark.usefixtures("_ros")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_program_cleanly(tmp_path: Path, number: signal.Signals) -> None:
    with subprocess.Popen(
        COMMAND, cwd=tmp_path, env=environment(), stderr=subprocess.PIPE, text=True
    ) as program:
        assert program.stderr is not None
        assert "logging to:" in program.stderr.readline()
        (log,) = (tmp_path / "metrics_analyzer/data/metric_logs").glob("metrics_log_*.csv")
        wait_for_a_row(log)
        program.send_signal(number)
        _, rest = program.communicate(timeout=TIMEOUT)
    assert program.returncode == 0
    assert rest == ""
    assert log.read_bytes().endswith(b",Normal operation\r\n")


@pytest.mark.usefixtures("_ros")
@pytest.mark.parametrize(
    ("parameter", "told"),
    [
        ("debug_mode:=1", "parameter debug_mode must be true or false, not 0 or 1"),
        ("collision_threshold:=1", "(1.0, not 1) from 0.0 to 100.0 m"),
        ("debug_interval:=0", "an integer from 1 to"),
        ("log_dir:=/dev/null", "/dev/null: File exists; a file stands where a folder should be"),
        ("debug_mode", "Couldn't parse parameter override rule"),
    ],
)
def test_a_known_mistake_is_told_in_one_line(tmp_path: Path, parameter: str, told: str) -> None:
    line = refused(tmp_path, "--ros-args", "-p", parameter)
    assert line.startswith("metrics_node: ")
    assert told in line


def test_without_ros_the_program_says_how_to_get_it(tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ImportError(\"No module named 'rclpy'\")\n")
    line = refused(tmp_path, env=environment(str(tmp_path)))
    assert "No module named 'rclpy'" in line
    assert "rover-harness[ros]" in line
    assert "source /opt/ros" in line


def test_without_ros_a_library_user_gets_an_import_error_to_catch(tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ImportError(\"No module named 'rclpy'\")\n")
    caller = (
        "from rover_metrics.errors import MissingRosError\n"
        "try:\n    import rover_metrics.metrics_node\n"
        "except MissingRosError as error:\n    print(error.exit_code, error)\n"
    )
    run = subprocess.run(
        [sys.executable, "-c", caller],
        env=environment(str(tmp_path)),
        capture_output=True,
        text=True,
        timeout=TIMEOUT,
        check=True,
    )
    assert run.stdout.startswith("2 metrics_node needs ROS 2")
