"""Runs through ROS as the other benchmarks need them: quiet, in a temporary folder, nothing lost."""

import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from harness.base.interrupt import Interrupted, StopRequest
from harness.episode.result import Outputs, RunResult
from harness.ros.session import run_through_ros
from harness.spec.ros import RosOptions
from harness.spec.run import Run

QUIET = ("--ros-args", "--log-level", "warn")
NODE = "/metrics_node"


def run(what: Run, wait_for: tuple[str, ...] = ()) -> RunResult:
    """Runs an episode with a MetricsNode here, or in lock-step with nodes elsewhere."""
    with TemporaryDirectory(prefix="harness_bench_") as folder, StopRequest() as stop:
        options = RosOptions(
            log_dir=Path(folder), host_metrics=not wait_for, wait_for=wait_for, ros_args=QUIET
        )
        (result,) = run_through_ros(what, (Outputs(log_dir=options.log_dir),), options, stop)
        if stop.signal is not None:
            raise Interrupted(stop.signal)
    assert result.failure is None, result.failure
    return result


@contextmanager
def metrics_node(name: str = "metrics_node") -> Iterator[tuple[int, Path]]:
    """A metrics_node in a process of its own; gives its process number and its folder of logs."""
    with TemporaryDirectory(prefix="harness_bench_") as folder:
        parameters = (
            "-r",
            f"__node:={name}",
            "-p",
            "use_sim_time:=true",
            "-p",
            f"log_dir:={folder}",
        )
        command = [sys.executable, "-m", "rover_metrics.metrics_node", *QUIET, *parameters]
        with subprocess.Popen(command) as process:
            try:
                yield process.pid, Path(folder)
            finally:
                process.terminate()
