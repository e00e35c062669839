"""What `harness.run` does about pictures: check before the run, keep its states, draw afterwards."""

import importlib.util
import tempfile
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, ExitStack, closing
from pathlib import Path

from harness.base.errors import UsageError
from harness.base.files import BESIDE, check_target
from harness.base.interrupt import StopRequest
from harness.episode.loop import Observer
from harness.samples import JointStates, Pose
from harness.spec.run import Run
from harness.view.artist import Artist, artist
from harness.view.states import StateWriter

SUFFIXES = {"--picture": ".png", "--video": ".mp4"}


class Drawing(AbstractContextManager["Drawing"]):
    """The picture and the video of one run; a context manager that leaves no states behind.

    The camera looks at the first rover; the others are shown too. What draws is started before the
    run: one that cannot be drawn ends at once, and its picture is there soon after it.

    Args:
        picture: Where to write a PNG of the run's end; None for none; BESIDE if `finish` says where, and
            if the run is to go on without it where nothing can draw.
        video: Where to write an MP4 of the run; None for none.
        lidar: Show the beams.
        camera: As `chase_view` takes it; "" leaves it to picture and video.
        backend: The OpenGL to be used, as MUJOCO_GL names it; "" for whichever works.

    Attributes:
        lack: Why there will be no picture; "" if there will, or if none is wanted.
    """

    def __init__(
        self,
        picture: Path | None,
        video: Path | None,
        *,
        lidar: bool,
        backend: str = "",
        camera: str = "",
    ) -> None:
        named = {"--picture": picture, "--video": video}
        self._targets = {flag: path for flag, path in named.items() if path is not None}
        self._lidar, self._backend, self._camera = lidar, backend, camera
        self.lack = ""
        self._at_end = ExitStack()
        self._artist: Artist | None = None
        self._writers: list[StateWriter] = []
        self._drawn: dict[str, Path] = {}

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
            if path != BESIDE:
                check_target(flag, path, SUFFIXES[flag])
        if "--video" in self._targets and importlib.util.find_spec("av") is None:
            raise UsageError("--video needs PyAV; install it with pip install 'rover-harness[video]'")
        try:
            self._artist = self._at_end.enter_context(artist(self._backend))
        except UsageError as error:
            if set(self._targets.values()) != {BESIDE}:
                raise
            self.lack = f"there is no picture: {error}"
            return
        folder = self._at_end.enter_context(tempfile.TemporaryDirectory(prefix="rover-harness-"))
        for number in range(len(run.rovers)):
            writer = StateWriter(Path(folder) / f"states_{number}", run, number)
            self._writers.append(self._at_end.enter_context(closing(writer)))

    @property
    def observers(self) -> Sequence[Observer]:
        """What keeps the states of each rover; empty if nothing is to be drawn."""
        return self._writers

    def drive(self, run: Run) -> None:
        """Drives a run for nothing but what is drawn of it."""
        from harness.episode.direct import run_unlogged  # noqa: PLC0415 - loads MuJoCo

        run_unlogged(run, StopRequest(), {Pose, JointStates}, self.observers)

    def begin(self, beside: Path = BESIDE) -> None:
        """Has the picture drawn, beside the log of the run if so, while the caller does other things."""
        if self._artist is None or self._drawn:
            return
        for writer in self._writers:
            writer.close()
        self._drawn = {
            flag: beside.with_suffix(SUFFIXES[flag]) if path == BESIDE else path
            for flag, path in self._targets.items()
        }
        files = {flag: str(path) for flag, path in self._drawn.items()}
        recordings = [str(writer.path) for writer in self._writers]
        look = {"camera": self._camera, "lidar": self._lidar}
        self._artist.begin({"recordings": recordings, "files": files, **look})

    def finish(self, show: Callable[[int, int], None]) -> list[Path]:
        """Waits for what is drawn in a process of its own; returns the files, or raises HarnessError.

        Args:
            show: Is called with the number of frames drawn and of all frames; of a picture there is one.
        """
        if self._artist is None:
            return []
        self.begin()
        self._artist.finish(show)
        return list(self._drawn.values())
