"""What a trial leaves if it fails: a recording of its topics and a page about its last episode."""

import sys
import tempfile
import time
from abc import ABC, abstractmethod
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from harness.base.errors import HarnessError
from harness.episode.batch import Batch, EpisodeInfo
from harness.episode.result import RunAccount, RunResult, TopicCount
from harness.messages.recorder import Recorder
from harness.page.run.evidence import keep_evidence
from harness.page.run.recorder import RunRecorder
from harness.ros.bridge import Bridge
from harness.ros.tap import Tap
from harness.spec.run import Run

RECORDING, PAGE = "trial.mcap", "trial.html"


class LeavesEvidence(ABC):
    """A context that keeps what it has recorded if an exception ends it.

    Attributes:
        artifacts: Folder for that; None for none, and once it is there.
    """

    def __init__(self, artifacts: Path | None) -> None:
        self.artifacts, self._has_evidence = artifacts, False
        self._at_end = ExitStack()

    @abstractmethod
    def keep(self, folder: Path, reason: str) -> tuple[Path, ...]:
        """Puts what there is to see, with the reason of the failure, into a folder; returns where."""

    def __exit__(self, _: object, error: BaseException | None, __: object) -> None:
        with self._at_end:
            if error is not None and (lines := self.keep_evidence(f"{type(error).__name__}: {error}")):
                print(lines, file=sys.stderr)

    def keep_evidence(self, reason: str) -> str:
        """Keeps in `artifacts` what `keep` does, once, with the first line of the reason of the failure.

        Returns:
            Where it is, in a line each, or why it is not; nothing if there is nothing to keep, or it was
            kept already.
        """
        folder, self.artifacts = self.artifacts, None
        if folder is None or not self._has_evidence:
            return ""
        try:
            kept = self.keep(folder, next(iter(reason.splitlines()), "an exception"))
        except (HarnessError, OSError) as error:
            return f"nothing could be kept of this trial: {error}"
        return "\n".join(f"kept: {path}" for path in kept)


class Recording(ExitStack):
    """Records what a bridge publishes and hears, the `last` seconds or all; leaves only what is kept."""

    def __init__(self, name: str = RECORDING, last: float | None = None) -> None:
        super().__init__()
        self._name, self._last = name, last

    def __enter__(self) -> Self:
        folder = self.enter_context(tempfile.TemporaryDirectory(prefix="rover-trial-"))
        self.path = Path(folder) / self._name
        self._open = self.enter_context(ExitStack())
        self._recorder = self._open.enter_context(Recorder(self.path, last=self._last))
        self.callback(self._recorder.forget)  # before it is closed, if `end` was not called
        self._tap = Tap(self._recorder)
        self.hear = self._tap.hear
        return self

    def tap(self, bridge: Bridge) -> None:
        """Records a bridge from now on."""
        self._open.callback(bridge.stop_recording)
        self._tap.tap(bridge)

    def end(self) -> Path | None:
        """Finishes the recording; returns where it is, None if it has no message."""
        self._open.close()
        return self.path if self.path.exists() else None


class Evidence:
    """Watches the batches of a trial, an Observer, for the page about its last episode.

    Args:
        bridge: Says how many messages it has published.
        run: What is driven.
        info: Its episode.
    """

    def __init__(self, bridge: Bridge, run: Run, info: EpisodeInfo) -> None:
        self._page = RunRecorder()
        self._account = RunAccount(
            RunResult(run=run, mode="a trial of harness.testing", info=info),
            started=time.monotonic(),
            show=None,
            topics=lambda: {topic: TopicCount(n) for topic, n in bridge.published().items()},
            rows=lambda: 0,
        )

    def take(self, batch: Batch) -> None:
        """Takes the next batch."""
        self._page.take(batch)
        self._account.take(batch)

    def keep(self, folder: Path, reason: str, recording: Recording) -> tuple[Path, ...]:
        """Ends the recording and keeps it with the page; returns their places.

        Args:
            folder: Gets both.
            reason: What failed, for the page.
            recording: Of the topics.
        """
        more = [recording.end()]
        return keep_evidence(self._account.ended(), self._page, folder / PAGE, reason, more)
