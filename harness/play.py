"""Command: look at a recording on the page of --live, with a slider of its time.

    python -m harness.play run.mcap

What is shown, and how, is the work of harness.view.live.
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
from harness.spec.live import LiveOptions
from harness.view.live import load_page, show_recording
from harness.view.live.recording import manifests_near, read_tracks, run_of
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
        show_recording(run, tracks, live, stop)
    return 0


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
