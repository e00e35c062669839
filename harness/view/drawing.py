"""What `harness.run` does about pictures: check before the run, keep its states, draw afterwards."""

import importlib.util
import os
import platform
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, closing
from pathlib import Path

from harness.base.errors import INSTALL_OPENGL, HarnessError, UsageError
from harness.base.files import check_target
from harness.episode.loop import Observer
from harness.sensors.camera.backend import backends
from harness.spec.run import Run
from harness.view.states import StateWriter

SUFFIXES = {"--picture": ".png", "--video": ".mp4"}
FRAMES = re.compile(r"(\d+)/(\d+)\n")  # how many are drawn of how many, as harness.view.picture says it
PROGRAM = (sys.executable, "-m", "harness.view.picture")


class DrawingFailed(HarnessError):
    """The run is done, its picture or video is not."""


class Drawing(AbstractContextManager["Drawing"]):
    """The picture and the video of one run; a context manager that leaves no states behind.

    The camera looks at the first rover; the others are shown too.

    Args:
        picture: Where to write a PNG of the run's end; None for none.
        video: Where to write an MP4 of the run; None for none.
        lidar: Show the beams.
        backend: The OpenGL to be used, as MUJOCO_GL names it; "" for whichever works.
    """

    def __init__(
        self, picture: Path | None, video: Path | None, *, lidar: bool, backend: str = ""
    ) -> None:
        named = {"--picture": picture, "--video": video}
        self._targets = {flag: path for flag, path in named.items() if path is not None}
        self._lidar, self._backend = lidar, backend
        self._at_end = ExitStack()
        self._environment: dict[str, str] = {}
        self._writers: list[StateWriter] = []

    @property
    def wanted(self) -> bool:
        """Whether anything is to be drawn."""
        return bool(self._targets)

    def __exit__(self, *_: object) -> None:
        self._at_end.close()

    def prepare(self, run: Run) -> None:
        """Opens the logs of states; a UsageError says what drawing needs and is not there."""
        if not self.wanted:
            if self._lidar:
                raise UsageError("--picture-lidar needs --picture or --video")
            return
        for flag, path in self._targets.items():
            check_target(flag, path, SUFFIXES[flag])
        if "--video" in self._targets and importlib.util.find_spec("av") is None:
            raise UsageError("--video needs PyAV; install it with pip install 'rover-harness[video]'")
        self._environment = _working_environment(self._backend)
        folder = self._at_end.enter_context(tempfile.TemporaryDirectory(prefix="rover-harness-"))
        for number in range(len(run.rovers)):
            writer = StateWriter(Path(folder) / f"states_{number}", run, number)
            self._writers.append(self._at_end.enter_context(closing(writer)))

    @property
    def observers(self) -> Sequence[Observer]:
        """What keeps the states of each rover; empty if nothing is to be drawn."""
        return self._writers

    def finish(self, show: Callable[[int, int], None]) -> list[Path]:
        """Draws in a process of its own; returns the files written, or raises DrawingFailed.

        `show` is called with the number of frames drawn and of all frames; of a picture there is one.
        """
        if not self._writers:
            return []
        for writer in self._writers:
            writer.close()
        words = [word for flag, path in self._targets.items() for word in (flag, str(path))]
        lidar = ["--lidar"] if self._lidar else []
        _call([*(str(w.path) for w in self._writers), *words, *lidar], self._environment, show)
        return list(self._targets.values())


def _call(
    words: list[str], environment: dict[str, str], show: Callable[[int, int], None] = lambda *_: None
) -> None:
    """Runs harness.view.picture, apart from Ctrl-C in this terminal, which stops it by its caller."""
    with (
        tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as said,
        subprocess.Popen(
            [*PROGRAM, *words],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=said,
            text=True,
            start_new_session=True,
        ) as process,
    ):
        try:
            for line in process.stdout or ():
                if match := FRAMES.fullmatch(line):
                    show(int(match[1]), int(match[2]))
        except BaseException:
            process.kill()
            raise
        if process.wait():
            said.seek(0)
            last = next(iter(said.read().strip().splitlines()[-1:]), f"exit code {process.returncode}")
            raise DrawingFailed(f"nothing was drawn: {last}")


def _working_environment(chosen: str) -> dict[str, str]:
    """The environment in which MuJoCo draws without a display; a UsageError if there is none."""
    known = backends(chosen)
    for backend in known:
        environment = os.environ | {"MUJOCO_GL": backend}
        try:
            _call([], environment)
        except DrawingFailed:
            continue
        return environment
    tried = " or ".join(known)
    mend = INSTALL_OPENGL.get(platform.system(), "start it where a window could be opened")
    raise UsageError(f"pictures need OpenGL, but MUJOCO_GL={tried} does not work here; {mend}")
