"""A process that draws: ready before a run, so that its picture need not wait for OpenGL."""

import json
import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, suppress

from harness.base.errors import INSTALL_OPENGL, HarnessError, UsageError
from harness.base.opengl import backends

READY = "ready\n"  # harness.view.picture says it when it can draw
FRAMES = re.compile(r"(\d+)/(\d+)\n")  # how many are drawn of how many, as harness.view.picture says it
PROGRAM = (sys.executable, "-m", "harness.view.picture")
PATIENCE = 10.0  # [s] for the process that draws to leave no half of a file behind


class Artist(AbstractContextManager["Artist"]):
    """A process of harness.view.picture that waits for what to draw; Ctrl-C stops its caller alone.

    Args:
        environment: In which it runs.

    Attributes:
        ready: Whether it has what it needs to draw.
    """

    def __init__(self, environment: dict[str, str]) -> None:
        self._said = tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace")  # noqa: SIM115
        self._process = subprocess.Popen(
            PROGRAM,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._said,
            text=True,
            start_new_session=True,
        )
        assert self._process.stdin is not None  # noqa: S101 - a pipe
        assert self._process.stdout is not None  # noqa: S101 - a pipe
        self._in, self._out = self._process.stdin, self._process.stdout
        try:
            self.ready = self._out.readline() == READY
        except BaseException:  # of a signal: nobody else knows of the process yet
            self.__exit__()
            raise

    def __exit__(self, *_: object) -> None:
        self._process.terminate()  # an unfinished file is taken away before the process ends
        try:
            self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        for file in (self._in, self._out, self._said):
            with suppress(OSError):
                file.close()

    def begin(self, order: Mapping[str, object]) -> None:
        """Has it draw what `harness.view.picture.draw` takes."""
        with suppress(BrokenPipeError):
            self._in.write(f"{json.dumps(order)}\n")
            self._in.close()

    def finish(self, show: Callable[[int, int], None]) -> None:
        """Waits for what it draws; HarnessError with what it says if it cannot."""
        for line in self._out:
            if match := FRAMES.fullmatch(line):
                show(int(match[1]), int(match[2]))
        if self._process.wait():
            self._said.seek(0)
            said = self._said.read().strip().splitlines()
            last = next(iter(said[-1:]), f"exit code {self._process.returncode}")
            raise HarnessError(f"nothing was drawn: {last}")


def artist(chosen: str) -> Artist:
    """Returns what draws without a display by OpenGL; a UsageError where nothing can."""
    known = backends(chosen)
    for backend in known:
        ready = Artist(os.environ | {"MUJOCO_GL": backend})
        if ready.ready:
            return ready
        ready.__exit__()
    tried = " or ".join(known)
    mend = INSTALL_OPENGL.get(platform.system(), "start it where a window could be opened")
    raise UsageError(f"pictures need OpenGL, but MUJOCO_GL={tried} does not work here; {mend}")
