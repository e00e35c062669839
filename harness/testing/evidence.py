"""What a trial leaves if it fails: a recording of its topics and a page about its last episode."""

import shutil
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from harness.base.errors import HarnessError
from harness.base.files import write_whole
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.result import RunAccount, RunResult, TopicCount
from harness.report.recorder import RunRecorder
from harness.ros.bridge import Bridge
from harness.ros.recorder import Recorder
from harness.spec.run import Run

RECORDING, PAGE = "trial.mcap", "trial.html"


class Recording(ExitStack):
    """Records what a bridge publishes and hears; a context that leaves nothing but what is kept.

    Args:
        bridge: Is recorded from now on.
        name: Of the file.
        last: How many seconds are kept; all if None.
    """

    def __init__(self, bridge: Bridge, name: str = RECORDING, last: float | None = None) -> None:
        super().__init__()
        folder = self.enter_context(tempfile.TemporaryDirectory(prefix="rover-trial-"))
        self.path = Path(folder) / name
        self._open = self.enter_context(ExitStack())
        self._recorder = self._open.enter_context(Recorder(self.path, last=last))
        self._open.callback(bridge.stop_recording)
        self._recorder.tap(bridge)
        self.callback(self._recorder.forget)  # before it is closed, if `end` was not called
        self.hear = self._recorder.hear

    def end(self) -> Path | None:
        """Finishes the recording; returns where it is, None if it has no message."""
        self._open.close()
        return self.path if self.path.exists() else None


class Evidence(Recording):
    """Watches the batches of a trial; an Observer."""

    def __init__(self, bridge: Bridge) -> None:
        super().__init__(bridge)
        self._bridge = bridge

    def begin(self, run: Run, info: EpisodeInfo) -> None:
        """Begins the account of an episode; the page is about the last."""
        self._page = RunRecorder()
        self._account = RunAccount(
            RunResult(run=run, mode="a trial of harness.testing", info=info),
            started=time.monotonic(),
            show=None,
            topics=lambda: {topic: TopicCount(n) for topic, n in self._bridge.published().items()},
            rows=lambda: 0,
        )

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._page.take(batch)
        self._account.take(batch)

    def keep(self, folder: Path, reason: str) -> str:
        """Ends the recording, puts it and the page into a folder, and says where they are.

        Args:
            folder: Is made if need be; files of these names are replaced.
            reason: Why the trial has failed, for the page.
        """
        from harness.report.content import render  # noqa: PLC0415 - a second that a passing trial saves

        try:
            recording = self.end()
            folder.mkdir(parents=True, exist_ok=True)
            kept = [folder / PAGE]
            if recording is not None:
                kept.append(Path(shutil.move(recording, folder / RECORDING)))
            result = self._account.ended(failure=reason)
            write_whole(folder / PAGE, render(result, self._page), "the page")
        except (HarnessError, OSError) as error:
            return f"nothing could be kept of this trial: {error}"
        return "\n".join(f"kept: {path}" for path in kept)
