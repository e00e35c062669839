"""From the command to the first CSV row, in a warm checkout."""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.measuring import Effort, Rounds, Table, timed

COMMAND = [sys.executable, "-m", "harness.run", "--terrain", "rocky", "--duration", "3"]
WAYS = {"through ROS 2": (), "--direct": ("--direct",)}
IMPORTS = "import harness.run"
TARGET = "<= 5 s"
GLANCE = 0.002  # [s] between two looks at the file


def measure(effort: Effort) -> Table:
    """Wall time to the first row of both kinds of run, and of the imports alone."""
    rounds = Rounds(
        {way: _to_first_row(options) for way, options in WAYS.items()}
        | {IMPORTS: timed(lambda: subprocess.run([sys.executable, "-c", IMPORTS], check=True))},
        effort.rounds,
    )
    return Table(
        title="Start of python -m harness.run --terrain rocky",
        columns=("way", "to the first row", "target"),
        rows=(
            *((way, f"**{rounds.median(way):.2f} s**", TARGET) for way in WAYS),
            (IMPORTS, f"{rounds.median(IMPORTS):.2f} s", "-"),
        ),
    )


def _to_first_row(options: tuple[str, ...]) -> Callable[[], float]:
    def run() -> float:
        with TemporaryDirectory(prefix="harness_bench_") as folder:
            start = time.perf_counter()
            command = [*COMMAND, *options, "--log-dir", folder]
            with subprocess.Popen(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            ) as process:
                try:
                    _await_row(Path(folder), process)
                    return time.perf_counter() - start
                finally:
                    process.terminate()

    return run


def _await_row(folder: Path, process: subprocess.Popen[bytes]) -> None:
    while not any(log.read_bytes().count(b"\n") > 1 for log in folder.glob("*.csv")):
        assert process.poll() is None, "the run ended without a row"
        time.sleep(GLANCE)
