"""Command: drive a rover over a terrain and log its traversal metrics.

    python -m harness.run --terrain rocky --robot leo --seed 0

Parses, calls, prints; the work is in harness.ros.session (through ROS) and harness.episode.direct
(without).
"""

import importlib
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

if __name__ == "__main__":  # what follows takes a second to load; Ctrl-C must not show where it was
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from rich.console import Console

from harness.cli.console import RunProgress, print_choices, print_summary
from harness.cli.options import RunOptions, parse_run
from harness.episode.manifest import write_manifest
from harness.episode.result import RunResult
from harness.errors import HarnessError, UsageError
from harness.files import check_target
from harness.interrupt import StopRequest
from harness.report import RunReport
from harness.view.drawing import Drawing, keep_opengl_out
from harness.world.heightmap.dem import is_terrain_file


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    console = Console()
    try:
        options = parse_run(sys.argv[1:] if arguments is None else arguments)
        if options is None:
            print_choices(console)
            return 0
        return _command(options, console)
    except HarnessError as error:
        print(f"harness.run: {error}", file=sys.stderr)
        return error.exit_code


def _command(options: RunOptions, console: Console) -> int:
    backend = keep_opengl_out()  # before MuJoCo is loaded
    drawing = Drawing(options.picture, options.video, lidar=options.picture_lidar, backend=backend)
    report = RunReport(options.report)
    _load(options)
    with StopRequest() as stop, drawing:
        result = _run(options, stop, console, drawing, report)
        result = replace(result, report=options.report)
        exit_code = _report(result, options.summary, stop, console)
        if (page := report.write(result)) is not None:
            console.print(f"report: {page}", soft_wrap=True, highlight=False)
        _draw(drawing, stop, console)
    return exit_code


def _load(options: RunOptions) -> None:
    """Loads what only these options need: MuJoCo and compiled kernels.

    Not with this module: through ROS, only the process that simulates needs them. Not later: a signal
    would then be raised in the midst of modules that are not prepared for it.
    """
    if options.direct:
        importlib.import_module("harness.episode.direct")
    if options.report is not None:
        importlib.import_module("harness.report.content")


def _run(
    options: RunOptions, stop: StopRequest, console: Console, drawing: Drawing, report: RunReport
) -> RunResult:
    config, ros = options.config, options.ros
    config.validate()
    if options.summary is not None:
        check_target("--summary", options.summary)
    report.prepare()
    for note in config.world().notes if is_terrain_file(config.terrain) else ():
        console.print(f"{config.terrain}: {note}", soft_wrap=True, highlight=False)
    drawing.prepare(config)
    observers = (drawing, report)
    title = f"{config.robot} on {config.terrain}"
    with RunProgress(console, title, config.duration) as bar:
        if options.direct:
            from harness.episode.direct import run_direct  # noqa: PLC0415 - see _load

            return run_direct(config, ros, stop, bar.show, observers, extended=options.extended)
        return _through_ros()(config, ros, stop, bar.show, observers)


def _through_ros() -> Callable[..., RunResult]:
    """Returns run_through_ros: --direct must work where there is no rclpy."""
    try:
        from harness.ros.session import run_through_ros  # noqa: PLC0415
    except ImportError as error:
        message = (
            f"ROS 2 is not importable ({error}); install the extra with pip install -e '.[ros]', "
            "source a ROS 2 installation, or run with --direct, which needs none"
        )
        raise UsageError(message) from error
    return run_through_ros


def _report(result: RunResult, summary: Path | None, stop: StopRequest, console: Console) -> int:
    """Prints and writes what a run came to; returns the exit code."""
    print_summary(console, result)
    complaints = [result.failure] if result.failure is not None else []
    if result.lost:
        lost = ", ".join(f"{c.lost} of {t}" for t, c in result.topics.items() if c.lost)
        complaints.append(f"messages were lost: {lost}")
    log_manifest = None if result.log_path is None else result.log_path.with_suffix(".json")
    complaints += [
        complaint
        for path in (log_manifest, summary)
        if path is not None and (complaint := _write(result, path)) is not None
    ]
    for complaint in complaints:
        print(f"harness.run: {complaint}", file=sys.stderr)
    return 1 if complaints else stop.exit_code


def _draw(drawing: Drawing, stop: StopRequest, console: Console) -> None:
    """Draws, which takes its time: whoever ended the run from outside is not kept waiting."""
    if drawing.wanted and stop.signal in (signal.SIGTERM, signal.SIGHUP):
        print(f"harness.run: nothing was drawn: stopped by {stop.signal.name}", file=sys.stderr)
        return
    if drawing.wanted and stop.signal is not None:
        console.print("drawing what there is; Ctrl-C again leaves it out", highlight=False)
    for path in drawing.finish():
        console.print(f"drawn: {path}", soft_wrap=True, highlight=False)


def _write(result: RunResult, path: Path) -> str | None:
    """Writes the manifest; gives the reason if that fails."""
    try:
        write_manifest(result, path)
    except HarnessError as error:
        return str(error)
    return None


if __name__ == "__main__":
    sys.exit(main())
