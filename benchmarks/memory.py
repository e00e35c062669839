"""Memory over a simulated hour: what each process holds after a minute and at the end (Linux)."""

import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks import ros_runs
from benchmarks.measuring import Effort, Table

MINUTE = 60  # rows: one per simulated second
GLANCE = 0.1  # [s] between two looks
LAST_ROWS = 5  # not looked at: the simulation is ahead of the rows, and is over before they are
TARGET = "< 5 MB"
MEGABYTE = 1e6

Sizes = dict[str, float]  # resident memory [bytes] by process


def measure(effort: Effort) -> Table:
    """Growth of every process, with a hosted MetricsNode and with one in a process of its own."""
    rows: list[tuple[str, ...]] = []
    with TemporaryDirectory(prefix="harness_bench_") as folder:
        command = _harness(effort, "--log-dir", folder)
        rows += _rows("one command", *_watched(command, Path(folder), effort.hour))
    with ros_runs.metrics_node() as (node, logs):
        command = _harness(effort, "--no-metrics", "--wait-for", ros_runs.NODE)
        rows += _rows("--wait-for", *_watched(command, logs, effort.hour, {"metrics_node": node}))
    return Table(
        title=f"Resident memory, {effort.hour:g} simulated seconds",
        columns=("run", "process", "after a minute", "at the end", "growth", "target"),
        rows=tuple(rows),
    )


def _harness(effort: Effort, *options: str) -> list[str]:
    run = [sys.executable, "-m", "harness.run", "--terrain", "rocky", "--duration", f"{effort.hour:g}"]
    return [*run, *options]


def _rows(run: str, minute: Sizes, end: Sizes) -> list[tuple[str, ...]]:
    return [
        (
            run,
            process,
            f"{minute[process] / MEGABYTE:.1f} MB",
            f"{end[process] / MEGABYTE:.1f} MB",
            f"**{(end[process] - minute[process]) / MEGABYTE:+.2f} MB**",
            TARGET,
        )
        for process in minute
    ]


def _watched(
    command: list[str], logs: Path, rows: float, others: dict[str, int] | None = None
) -> tuple[Sizes, Sizes]:
    """Sizes after the first minute and shortly before the last row."""
    minute: Sizes = {}
    end: Sizes = {}
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None:
            time.sleep(GLANCE)
            if MINUTE <= _rows_in(logs) < rows - LAST_ROWS:
                end = _sizes(process.pid, others or {}) or end
                minute = minute or end
    assert process.returncode == 0, f"{' '.join(command)} failed"
    assert minute, "the run was over before anybody looked"
    return minute, end


def _sizes(harness: int, others: dict[str, int]) -> Sizes:
    """Memory of the harness, its largest child (the simulation) and others; empty if one is gone."""
    try:
        children = Path(f"/proc/{harness}/task/{harness}/children").read_text().split()
        found = {
            "harness": _resident(harness),
            "simulation": max((_resident(int(child)) for child in children), default=0.0),
        } | {name: _resident(number) for name, number in others.items()}
    except OSError:
        return {}
    return found if all(found.values()) else {}


def _resident(process: int) -> float:
    """Resident memory [bytes]; 0 for a process that has ended."""
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return float(line.split()[1]) * 1024
    return 0.0


def _rows_in(logs: Path) -> int:
    return sum(log.read_bytes().count(b"\n") - 1 for log in logs.glob("*.csv"))
