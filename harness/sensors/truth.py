"""The truth in the shape of a sensor, so that it travels with the readings that it judges."""

from harness.samples import TruthState
from harness.truth.recorder import TruthRecorder

TRUTH_RATE = 20  # [Hz]


class TruthSensor:
    """Reads a recorder; nothing corrupts what it says."""

    def __init__(self, recorder: TruthRecorder, period_ticks: int) -> None:
        self.period_ticks = period_ticks
        self._recorder = recorder

    def read(self) -> TruthState:
        """The truth now and since the last reading."""
        return self._recorder.state()
