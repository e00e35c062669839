"""Command: look at a recording on the page of --live, with a slider of its time.

    python -m harness.play run.mcap

What is shown, and how, is the work of harness.live.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from harness.base.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.play")

from harness.base.interrupt import StopRequest
from harness.cli.flags import add_flags, from_flags
from harness.cli.run_parser import DEFAULT_LOG_DIR
from harness.episode.helm import Helm
from harness.live import load_page
from harness.live.page import LivePage
from harness.live.player import FRAME, Player
from harness.live.recording import Track, manifests_near, read_tracks, run_of
from harness.spec.live import LiveOptions
from harness.spec.run import Run
from rover_metrics.parser import OneLineParser


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return run_program("harness.play", lambda: _play(_parser().parse_args(arguments)))


def _play(options: argparse.Namespace) -> int:
    recording, live = options.recording, from_flags(LiveOptions, options).served()
    near = manifests_near(recording.parent, DEFAULT_LOG_DIR)
    run = run_of(recording, options.manifest or (), near)
    tracks = read_tracks(recording, run)
    load_page(live)
    with StopRequest() as stop:
        _show(run, tracks, live, stop)
    return 0


def _show(run: Run, tracks: Sequence[Track], options: LiveOptions, stop: StopRequest) -> None:
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


def _parser() -> argparse.ArgumentParser:
    parser = OneLineParser(
        prog="python -m harness.play",
        description="Opens a recording of a run on the page of --live, with a slider of its time, until "
        "Ctrl-C (extra [live]).",
    )
    about = "of --record: MCAP, or a bag's folder"
    parser.add_argument("recording", type=Path, metavar="FILE.mcap", help=about)
    about = "manifest of the run, of several rovers all; default: looked for beside the recording and in"
    parser.add_argument(
        "--manifest", type=Path, nargs="+", metavar="FILE.json", help=f"{about} {DEFAULT_LOG_DIR}"
    )
    add_flags(parser.add_argument_group("live"), LiveOptions)
    return parser


if __name__ == "__main__":
    sys.exit(main())
