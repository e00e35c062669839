"""A recording of a trial's topics, of which nothing is left unless it is kept."""

import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from harness.messages.recorder import Recorder
from harness.ros.bridge import Bridge
from harness.ros.tap import Tap

RECORDING = "trial.mcap"


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
