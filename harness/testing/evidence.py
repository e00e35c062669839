"""What a trial leaves if it fails: a recording of its topics and a page about its last episode."""

import shutil
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from harness.config import EpisodeConfig
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.result import RunAccount, RunResult, TopicCount
from harness.errors import HarnessError
from harness.files import write_whole
from harness.report.recorder import RunRecorder
from harness.ros.bridge import Bridge
from harness.ros.recorder import Recorder

RECORDING, PAGE = "trial.mcap", "trial.html"


class Evidence(ExitStack):
    """Watches the batches of a trial; an Observer, and a context that leaves nothing but what is kept.

    Args:
        bridge: Publishes them.
    """

    def __init__(self, bridge: Bridge) -> None:
        super().__init__()
        self._bridge = bridge
        folder = self.enter_context(tempfile.TemporaryDirectory(prefix="rover-trial-"))
        self._recording = Path(folder) / RECORDING
        self._recorder = self.enter_context(ExitStack())
        self._recorder.enter_context(recorder := Recorder(self._recording))
        self._recorder.callback(bridge.stop_recording)
        recorder.tap(bridge)

    def begin(self, config: EpisodeConfig, info: EpisodeInfo) -> None:
        """Begins the account of an episode; the page is about the last."""
        self._page = RunRecorder()
        self._account = RunAccount(
            RunResult(config=config, mode="a trial of harness.testing", info=info),
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
            self._recorder.close()
            folder.mkdir(parents=True, exist_ok=True)
            kept = [folder / PAGE]
            if self._recording.exists():
                kept.append(Path(shutil.move(self._recording, folder / RECORDING)))
            result = self._account.ended(failure=reason)
            write_whole(folder / PAGE, render(result, self._page), "the page")
        except (HarnessError, OSError) as error:
            return f"nothing could be kept of this trial: {error}"
        return "\n".join(f"kept: {path}" for path in kept)
