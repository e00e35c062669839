"""Metrics nodes in processes of their own, and what is done to them and to a run."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.resident import rows_in
from benchmarks.soak.drive import running

BUSY = [sys.executable, "-S", "-c", "while True: pass"]
QUIET = ("--ros-args", "--log-level", "error")


@dataclass(frozen=True, slots=True)
class Listener:
    """A metrics node elsewhere: its name, its process number, the folder that it logs into."""

    name: str
    process: int
    logs: Path


@contextmanager
def metrics_nodes(count: int, folder: Path) -> Iterator[list[Listener]]:
    """So many of them, named node_0 and on, gone afterwards."""
    with ExitStack() as at_end:
        listeners = []
        for index in range(count):
            name = f"node_{index}"
            logs = folder / name
            words = (
                "-r",
                f"__node:={name}",
                "-p",
                "use_sim_time:=true",
                "-p",
                f"log_dir:={folder / name}",
            )
            command = [sys.executable, "-m", "rover_metrics.metrics_node", *QUIET, *words]
            process = at_end.enter_context(running(command, subprocess.DEVNULL))
            listeners.append(Listener(name, process.pid, logs))
        yield listeners


def waiting_for(listeners: list[Listener]) -> list[str]:
    """What makes harness.run keep lock-step with them, and with nobody else."""
    return ["--no-metrics", *(word for one in listeners for word in ("--wait-for", f"/{one.name}"))]


class Stutter:
    """Stops a process at one look and lets it go on at the next.

    Attributes:
        stops: How often it has been stopped.
    """

    def __init__(self, process: int) -> None:
        self._process = process
        self._stopped = False
        self.stops = 0

    def look(self) -> None:
        """Stops it, or lets it go on."""
        self._stopped = not self._stopped
        self.stops += self._stopped
        os.kill(self._process, signal.SIGSTOP if self._stopped else signal.SIGCONT)


class Competition(ExitStack):
    """Processes that want nothing but time on the processor, from the first row on; then gone again.

    Args:
        processes: How many.
        logs: Where the run logs that they shall hold up.
    """

    def __init__(self, processes: int, logs: Path) -> None:
        super().__init__()
        self._waiting, self._logs = processes, logs

    def look(self) -> None:
        """Lets them loose once the run drives."""
        while self._waiting and rows_in(self._logs):
            self.enter_context(running(BUSY, subprocess.DEVNULL))
            self._waiting -= 1
