"""One run of harness.run in a process of its own, watched while it drives."""

import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from harness.base.errors import RunFailed

HARNESS = (sys.executable, "-m", "harness.run")
GLANCE = 0.1  # [s] between two looks
PATIENCE = 3.0  # [s] for a process to end when it is asked to


def drive(words: Sequence[str], folder: Path, glance: Callable[[int], None]) -> dict[str, Any]:
    """Runs to the planned end.

    Args:
        words: Arguments of harness.run.
        folder: An empty one, for what it says.
        glance: Is called every GLANCE seconds with its process number.

    Returns:
        Its manifest.

    Raises:
        RunFailed: It did not come to its end.
    """
    summary, output = folder / "summary.json", folder / "output.txt"
    command = [*HARNESS, *words, "--summary", str(summary)]
    with output.open("wb") as said, running(command, said) as process:
        while process.poll() is None:
            time.sleep(GLANCE)
            glance(process.pid)
    if not summary.exists():
        last_words = output.read_text(errors="replace").strip().splitlines()[-1:]
        raise RunFailed(f"harness.run ended with {process.returncode}: {' '.join(last_words)}")
    told: dict[str, Any] = json.loads(summary.read_text())
    return told


@contextmanager
def running(command: Sequence[str], said: IO[bytes] | int) -> Iterator[subprocess.Popen[bytes]]:
    """A process that is gone afterwards: asked to end, so that it ends its children, or else made to."""
    with subprocess.Popen(command, stdout=said, stderr=said) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.send_signal(signal.SIGCONT)  # who is stopped does not hear the other
            try:
                process.wait(PATIENCE)
            except subprocess.TimeoutExpired:
                process.kill()
