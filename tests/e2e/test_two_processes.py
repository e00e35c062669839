"""The harness and a metrics_node of its own process, over real DDS, as a user starts them."""

import csv
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from harness.run import main
from tests.support.waiting import PATIENCE

rclpy = pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

METRICS_NODE = [sys.executable, "-m", "rover_metrics.metrics_node"]
SCRIPT = Path(sys.executable).with_name("metrics_node")
HARNESS = [sys.executable, "-m", "harness.run", "--no-metrics", "--wait-for", "/metrics_node"]


@contextmanager
def started(command: list[str], cwd: Path) -> Iterator[subprocess.Popen[str]]:
    """A process with piped output that is gone afterwards, whatever happens."""
    with subprocess.Popen(
        command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def metrics_node(log_dir: Path) -> list[str]:
    node = [str(SCRIPT)] if SCRIPT.exists() else METRICS_NODE
    return [*node, "--ros-args", "-p", "use_sim_time:=true", "-p", f"log_dir:={log_dir}"]


def finished(process: subprocess.Popen[str]) -> str:
    """The whole output of a process that ends by itself."""
    output, _ = process.communicate(timeout=PATIENCE)
    return output


def only_log(log_dir: Path) -> Path:
    (log,) = log_dir.glob("*.csv")
    return log


class Client:
    """Somebody with `ros2 param set`, who also waits for conditions by spinning."""

    def __init__(self, at_end: ExitStack) -> None:
        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        at_end.callback(self.context.try_shutdown)
        self.node = rclpy.create_node("client", context=self.context)
        self.executor = rclpy.executors.SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)

    def wait(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < deadline, "the condition did not come true"
            self.executor.spin_once(timeout_sec=0.05)

    def set(self, name: str, value: object) -> tuple[bool, str]:
        from rclpy.parameter import Parameter  # noqa: PLC0415 - after importorskip
        from rclpy.parameter_client import AsyncParameterClient  # noqa: PLC0415

        parameters = AsyncParameterClient(self.node, "/metrics_node")
        self.wait(parameters.services_are_ready)
        future = parameters.set_parameters([Parameter(name, value=value)])
        self.wait(future.done)
        (result,) = future.result().results
        return result.successful, result.reason


@pytest.mark.usefixtures("ros_domain")
def test_lock_step_across_processes_writes_the_same_csv_as_without_ros(tmp_path: Path) -> None:
    words = ["--terrain", "rocky", "--robot", "rover_zero4wd", "--duration", "5"]
    with started(metrics_node(tmp_path / "node"), tmp_path) as node:
        with started([*HARNESS, *words], tmp_path) as harness:
            told = finished(harness)
            assert harness.returncode == 0, told
        node.send_signal(signal.SIGINT)
        said = finished(node)
        assert node.returncode == 0, said
    assert "logging to: " in said
    assert "Traceback" not in said + told
    assert re.search(r"/scan +\D*100 +\D*100 +\D*0\b", told)
    assert re.search(r"(?m)^/metrics_node: [1-9]\d?% of the run waited for it$", told)
    assert main([*words, "--direct", "--log-dir", str(tmp_path / "direct")]) == 0
    assert only_log(tmp_path / "node").read_bytes() == only_log(tmp_path / "direct").read_bytes()


@pytest.mark.usefixtures("ros_domain")
def test_parameters_change_at_run_time_and_ctrl_c_ends_both_cleanly(tmp_path: Path) -> None:
    log_dir = tmp_path / "node"
    with ExitStack() as at_end:
        node = at_end.enter_context(started(metrics_node(log_dir), tmp_path))
        words = ["--terrain", "maze", "--driver", "cmd_vel", "--duration", "36000", "--rate", "8"]
        harness = at_end.enter_context(started([*HARNESS, *words], tmp_path))
        client = Client(at_end)
        client.wait(lambda: len(rows(log_dir)) >= 3)
        assert rows(log_dir)[-1]["Total Collisions"] == "0"

        assert client.set("collision_threshold", 9.0) == (True, "")
        accepted, reason = client.set("collision_threshold", -1.0)
        assert not accepted
        assert "collision_threshold" in reason
        client.wait(lambda: int(rows(log_dir)[-1]["Total Collisions"]) > 0)

        harness.send_signal(signal.SIGINT)
        told = finished(harness)
        assert harness.returncode == 130, told
        node.send_signal(signal.SIGINT)
        said = finished(node)
        assert node.returncode == 0, said
    assert "Traceback" not in told + said
    assert "0 lost" in told
    text = only_log(log_dir).read_bytes()
    assert text.endswith(b"Normal operation\r\n")
    stamps = [int(row["Timestamp"]) for row in rows(log_dir)]
    assert stamps == list(range(1, len(stamps) + 1))


def rows(log_dir: Path) -> list[dict[str, str]]:
    """The whole rows written so far; none before the node has made its file."""
    if not list(log_dir.glob("*.csv")):
        return []
    with only_log(log_dir).open(newline="") as file:
        return [row for row in csv.DictReader(file) if row["Notes"] is not None]
