"""The clock of a recording that is played: it goes on, stands still, and is put where a slider says."""

from harness.base.sim_time import CONTROL_PERIOD_NS, NANOSECONDS
from harness.episode.helm import Helm

FRAME = 0.05  # [s] of wall time between two states that are shown


class Player:
    """The time of a recording that is played, `time_ns` of `end_ns`; it may be put elsewhere."""

    def __init__(self, end_ns: int) -> None:
        self.end_ns, self.time_ns = end_ns, 0

    @property
    def end_s(self) -> float:
        """When the recording ends [s]."""
        return self.end_ns / NANOSECONDS

    def seek(self, time_s: float) -> None:
        """Goes to a time."""
        self.time_ns = round(time_s * NANOSECONDS)

    def go_on(self, helm: Helm) -> None:
        """Goes on by a frame at the helm's rate, or by a step; at its end it stands."""
        if not helm.paused:
            self.time_ns += round(FRAME * NANOSECONDS * (helm.rate or self.end_s))
        elif helm.take_step():
            self.time_ns += CONTROL_PERIOD_NS
        self.time_ns = min(self.time_ns, self.end_ns)
