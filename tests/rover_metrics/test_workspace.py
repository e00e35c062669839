"""A colcon workspace as a user makes it: built, sourced, its node run with parameters and stopped."""

import csv
import os
import shlex
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from rover_metrics.log.session_record import SessionEnd, session_end
from tests.rover_metrics.test_replay import drive, write_mcap
from tests.support.dependencies import depended_on, hide_all_but, told_to_install
from tests.support.once import made_once
from tests.support.waiting import PATIENCE, wait_until

PACKAGE = Path(__file__).parents[2] / "rover_metrics"
COLCON = shutil.which("colcon", path=str(Path(sys.executable).parent))  # the node runs in its Python
NOT_SOURCED = ("PYTHONPATH", "AMENT_PREFIX_PATH", "COLCON_PREFIX_PATH")

pytestmark = pytest.mark.skipif(COLCON is None, reason="needs colcon: pip install .[dev]")


def environment() -> dict[str, str]:
    """A shell's in which no workspace has been sourced."""
    return {name: value for name, value in os.environ.items() if name not in NOT_SOURCED}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package in src/, built."""
    folder = tmp_path_factory.mktemp("workspace")
    return made_once(tmp_path_factory, "workspace", lambda: built(folder))


def built(folder: Path) -> Path:
    assert COLCON is not None
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info", "build")
    shutil.copytree(PACKAGE, folder / "src/rover_metrics", ignore=ignored)
    command = [COLCON, "build", "--packages-select", "rover_metrics"]
    build = subprocess.run(
        command, cwd=folder, env=environment(), capture_output=True, text=True, check=False
    )
    assert build.returncode == 0, build.stdout + build.stderr
    return folder


def sourced(workspace: Path, *command: str) -> list[str]:
    """A command in a shell that has sourced the workspace; it replaces that shell."""
    setup = shlex.quote(str(workspace / "install/setup.bash"))
    return ["bash", "-c", f'source {setup} && exec "$@"', "bash", *command]


@pytest.fixture
def declared_only(tmp_path: Path) -> dict[str, str]:
    """The environment of a machine that has what the package declares, and nothing else."""
    hide_all_but(depended_on() | told_to_install(), tmp_path)
    return {**environment(), "PYTHONPATH": str(tmp_path)}


def told(workspace: Path, code: str) -> str:
    """What a Python program prints in the sourced workspace."""
    command = sourced(workspace, sys.executable, "-c", code)
    run = subprocess.run(
        command, cwd=workspace, env=environment(), capture_output=True, text=True, check=True
    )
    return run.stdout.strip()


@contextmanager
def running(workspace: Path, folder: Path, *words: str) -> Iterator["subprocess.Popen[str]"]:
    """The installed metrics_node as ros2 run starts it; gone afterwards."""
    program = str(workspace / "install/rover_metrics/lib/rover_metrics/metrics_node")
    with subprocess.Popen(
        sourced(workspace, program, "--ros-args", *words),
        cwd=folder,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    ) as node:
        try:
            yield node
        finally:
            node.kill()


def test_the_sourced_workspace_brings_the_package_whole(workspace: Path) -> None:
    where = told(workspace, "import rover_metrics; print(rover_metrics.__file__)")
    assert Path(where).is_relative_to(workspace / "install")
    installed = {path.relative_to(Path(where).parent) for path in Path(where).parent.rglob("*.py")}
    source = PACKAGE / "rover_metrics"
    assert installed == {path.relative_to(source) for path in source.rglob("*.py")}


def test_the_commands_need_only_what_is_declared(
    workspace: Path, tmp_path: Path, declared_only: dict[str, str]
) -> None:
    programs = workspace / "install/rover_metrics/lib/rover_metrics"
    bag = write_mcap(tmp_path / "bag.mcap", drive())
    for words, told in (
        ([programs / "replay", bag, "-o", tmp_path / "rows.csv"], "4 rows in "),
        ([programs / "analyze", tmp_path / "rows.csv", "-p"], "rows: 4 rows, 3 s"),
    ):
        command = sourced(workspace, *map(str, words))
        run = subprocess.run(
            command, cwd=tmp_path, env=declared_only, capture_output=True, text=True, check=False
        )
        assert (run.returncode, run.stderr) == (0, "")
        assert told in run.stdout


@pytest.mark.usefixtures("ros_domain")
def test_the_node_takes_parameters_logs_and_ends_cleanly(workspace: Path, tmp_path: Path) -> None:
    pytest.importorskip("rclpy", reason="needs ROS 2: pip install 'rover-harness[ros]'")
    parameters = workspace / "install/rover_metrics/share/rover_metrics/config/metrics.yaml"
    words = ["--params-file", str(parameters), "-p", "log_dir:=logs", "-r", "__ns:=/rover1"]

    def rows() -> int:
        return sum(len(log.read_bytes().splitlines()) - 1 for log in (tmp_path / "logs").glob("*.csv"))

    with running(workspace, tmp_path, *words) as node:
        wait_until(lambda: rows() >= 1 or node.poll() is not None)
        node.send_signal(signal.SIGINT)
        _, errors = node.communicate(timeout=PATIENCE)
    assert node.returncode == 0, errors
    assert "[rover1.metrics_node]: logging to: " in errors
    (log,) = (tmp_path / "logs").glob("metrics_log_*.csv")
    header, *written = csv.reader(log.read_text().splitlines())
    assert len(header) == 12
    assert all(row[-1] == "Normal operation" for row in written)
    assert session_end(log) is SessionEnd.MARKED
