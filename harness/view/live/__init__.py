"""A run as a page that is open while it goes on: watched, paused, steered (extra [live]).

`watched` is the door of a run, `show_recording` that of a recording. The page takes what there is to see
from observers of the run and shows it at its own pace; a Helm takes what is ordered on it.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING

from harness.base.interrupt import StopRequest
from harness.episode.helm import Helm
from harness.episode.loop import Observer
from harness.spec.live import LiveOptions
from harness.spec.run import Run

if TYPE_CHECKING:
    from harness.view.live.recording import Track


def load_page(options: LiveOptions) -> None:
    """Loads what a page takes, if one is wanted; call it while a signal still ends the process at once.

    What a StopRequest raises is swallowed by libraries of viser that are just being loaded.
    """
    if options.live is not None and find_spec("viser") is not None:  # else `watched` says so
        import_module("harness.view.live.panel")


@contextmanager
def watched(
    run: Run, options: LiveOptions, rate: float | None, stop: StopRequest
) -> Iterator[tuple[Helm | None, Sequence[Observer]]]:
    """Serves the page of a run, if one is wanted, and prints its address.

    Args:
        run: What is shown.
        options: Where it is served.
        rate: Of the run at first, times real time; None for as fast as it can.
        stop: Ends the run.

    Yields:
        What steers the run there, and what must see the batches of each rover; None and nothing where
        nobody watches, which costs nothing.

    Raises:
        UsageError: viser is missing, or it cannot be served there.
    """
    if options.live is None:
        yield None, ()
        return
    from harness.view.live.page import LivePage  # noqa: PLC0415 - its extra may be missing

    helm = Helm(rate, stop)
    with LivePage(run, helm, options) as page:
        print(f"live: {page.address}", flush=True)  # a pipe's reader opens it now
        yield helm, page.observers


def show_recording(run: Run, tracks: Sequence["Track"], options: LiveOptions, stop: StopRequest) -> None:
    """Serves a recording until somebody stops that, and prints the address of its page.

    Args:
        run: Of which it is.
        tracks: What it has of each rover.
        options: Where it is served.
        stop: Ends it.

    Raises:
        UsageError: viser is missing, or it cannot be served there.
    """
    from harness.view.live.page import LivePage  # noqa: PLC0415 - its extra may be missing
    from harness.view.live.recording import FRAME, Player  # noqa: PLC0415

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
