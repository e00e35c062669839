"""Plays a recording on a page: a clock that goes on, stands still, and is put where a slider says."""

from collections.abc import Sequence

from harness.base.interrupt import StopRequest
from harness.base.sim_time import CONTROL_PERIOD_NS, NANOSECONDS
from harness.episode.helm import Helm
from harness.live.page import LivePage
from harness.live.recording import Track
from harness.spec.live import LiveOptions
from harness.spec.run import Run

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


def play(run: Run, tracks: Sequence[Track], options: LiveOptions, stop: StopRequest) -> None:
    """Serves a recording until somebody stops that.

    Args:
        run: Of which it is.
        tracks: What it has of each rover.
        options: Where it is served.
        stop: Ends it.
    """
    helm = Helm(1.0, stop)
    player = Player(max(track.poses.times[-1] for track in tracks))
    with LivePage(run, helm, options, steered=False, player=player) as page:
        print(f"view: {page.address}", flush=True)
        shown: int | None = None
        with stop.deferred():
            while stop.signal is None:
                if shown != player.time_ns:
                    shown = player.time_ns
                    for track, watch in zip(tracks, page.observers, strict=True):
                        track.show(watch, shown)
                stop.sleep(FRAME)
                player.go_on(helm)
