"""Memory over a simulated hour: what each process holds after a minute and at the end (Linux)."""

import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks import ros_runs
from benchmarks.measuring import Effort, Table
from benchmarks.resident import MEGABYTE, Growth

GLANCE = 0.1  # [s] between two looks
TARGET = "< 5 MB"


def measure(effort: Effort) -> Table:
    """Growth of every process, with a hosted MetricsNode and with one in a process of its own."""
    rows: list[tuple[str, ...]] = []
    with TemporaryDirectory(prefix="harness_bench_") as folder:
        command = _harness(effort, "--log-dir", folder)
        rows += _rows("one command", _watched(command, Growth(Path(folder), effort.hour)))
    with ros_runs.metrics_node() as (node, logs):
        command = _harness(effort, "--no-metrics", "--wait-for", ros_runs.NODE)
        growth = Growth(logs, effort.hour, {"metrics_node": node})
        rows += _rows("--wait-for", _watched(command, growth))
    return Table(
        title=f"Resident memory, {effort.hour:g} simulated seconds",
        columns=("run", "process", "after a minute", "at the end", "growth", "target"),
        rows=tuple(rows),
    )


def _harness(effort: Effort, *options: str) -> list[str]:
    run = [sys.executable, "-m", "harness.run", "--terrain", "rocky", "--duration", f"{effort.hour:g}"]
    return [*run, *options]


def _rows(run: str, growth: Growth) -> list[tuple[str, ...]]:
    return [
        (
            run,
            process,
            f"{growth.minute[process] / MEGABYTE:.1f} MB",
            f"{growth.end[process] / MEGABYTE:.1f} MB",
            f"**{grown / MEGABYTE:+.2f} MB**",
            TARGET,
        )
        for process, grown in growth.grown.items()
    ]


def _watched(command: list[str], growth: Growth) -> Growth:
    """Looks at a run until it ends."""
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None:
            time.sleep(GLANCE)
            growth.look(process.pid)
    assert process.returncode == 0, f"{' '.join(command)} failed"
    assert growth.minute, "the run was over before anybody looked"
    return growth
