"""From the command to the first CSV row, to the help of any command, in a warm checkout."""

import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.measuring import Effort, Rounds, Table, timed

COMMAND = [sys.executable, "-m", "harness.run", "--terrain", "rocky", "--duration", "3"]
WAYS = {"through ROS 2": (), "--direct": ("--direct",)}
IMPORTS = "import harness.run"
GOALS = {"through ROS 2": 1.5, "--direct": 0.9, IMPORTS: 0.25}  # [s]
HELP = 0.4  # [s]
PROGRAMS = [f"harness.{name}" for name in ("run", "scenario", "tune", "check", "robot", "validate")]
PROGRAMS += [f"rover_metrics.{name}" for name in ("analyze", "replay", "social")]
GLANCE = 0.002  # [s] between two looks at the file


def measure(effort: Effort) -> Table:
    """Wall time to the first row of both kinds of run, and of the imports alone."""
    helps = {f"{name} --help": ("-m", name, "--help") for name in PROGRAMS}
    commands = {IMPORTS: ("-c", IMPORTS), **helps}
    rounds = Rounds(
        {way: _to_first_row(options) for way, options in WAYS.items()}
        | {way: timed(partial(_call, arguments)) for way, arguments in commands.items()},
        effort.rounds,
    )
    goals = GOALS | dict.fromkeys(helps, HELP)
    return Table(
        title="Start of python -m harness.run --terrain rocky, and of help",
        columns=("way", "to the first row, or to the end", "target"),
        rows=tuple((way, *_cells(rounds.median(way), goals.get(way))) for way in (*WAYS, *commands)),
    )


def _cells(seconds: float, goal: float | None) -> tuple[str, str]:
    late = " (too long)" if goal is not None and seconds > goal else ""
    return f"**{seconds:.2f} s**{late}", "-" if goal is None else f"<= {goal:g} s"


def _call(arguments: Sequence[str]) -> None:
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL)


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
