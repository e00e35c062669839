"""Command: drive a rover over a terrain and log its traversal metrics.

    python -m harness.run --terrain rocky --robot leo --seed 0

Parses, calls, prints; the work is in harness.ros.session (through ROS) and harness.episode.direct
(without).
"""

import importlib
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from harness.cli.edge import begin_program, run_program

if __name__ == "__main__":
    begin_program("harness.run")

from rich.console import Console

from harness.cli.console import RunProgress, counted, print_choices, print_summary
from harness.cli.options import RunOptions, parse_run
from harness.episode.loop import Observer
from harness.episode.manifest import write_manifest
from harness.episode.result import Run, RunResult
from harness.episode.social_recorder import SocialRecorder
from harness.errors import INSTALL_ROS, HarnessError, UsageError
from harness.files import check_target, write_whole
from harness.interrupt import HANGUP, StopRequest
from harness.report.recorder import RunRecorder
from harness.robots import robot_name
from harness.sensors.camera.backend import keep_opengl_out
from harness.view.drawing import Drawing
from harness.world.terrain_file import is_terrain_file


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    return run_program("harness.run", lambda: _main(sys.argv[1:] if arguments is None else arguments))


def _main(arguments: Sequence[str]) -> int:
    console = Console()
    options = parse_run(arguments)
    if options is None:
        print_choices(console)
        return 0
    return _command(options, console)


def _command(options: RunOptions, console: Console) -> int:
    options.config.validate()
    backend = keep_opengl_out()  # before MuJoCo is loaded
    drawing = Drawing(options.picture, options.video, lidar=options.picture_lidar, backend=backend)
    recorder, social = RunRecorder(), _social(options)
    observers = (*social, *((recorder,) if options.report is not None else ()))
    run = _loaded(options)
    with StopRequest() as stop, drawing:
        result = _run(run, options, stop, console, drawing, observers)
        result = replace(result, report=options.report, params=options.params)
        for log in social:
            log.close()
            result = replace(result, social_log=log.path)
        exit_code = _report(result, options.summary, stop, console)
        if options.report is not None:
            from harness.report.content import render  # noqa: PLC0415 - see `_loaded`

            with console.status("drawing the page"):
                write_whole(options.report, render(result, recorder), "the report")
            console.print(f"report: {options.report}", soft_wrap=True, highlight=False)
        _draw(drawing, stop, console)
    return exit_code


def _social(options: RunOptions) -> tuple[SocialRecorder, ...]:
    """Returns what keeps the social log of a run with people.

    Raises:
        UsageError: It cannot be written there.
    """
    names = options.config.actor_names()
    if options.social_log is not None:
        check_target("--social-log", options.social_log, ".csv")
    return (SocialRecorder(names, options.social_log, options.ros.log_dir),) if names else ()


def _loaded(options: RunOptions) -> Run:
    """Returns what runs the episode, with what only these options need: ROS, MuJoCo, compiled kernels.

    Not with this module: through ROS, only the process that simulates needs the latter, and --direct
    must work where there is no rclpy. Not later: a signal would then be raised in the midst of modules
    that are not prepared for it.

    Raises:
        UsageError: ROS 2 is missing.
    """
    if options.report is not None:
        importlib.import_module("harness.report.content")
    if options.direct:
        from harness.episode.direct import run_direct  # noqa: PLC0415

        return partial(run_direct, settings=options.settings)
    try:
        from harness.ros.session import run_through_ros  # noqa: PLC0415
    except ImportError as error:
        raise UsageError(
            f"ROS 2 is not importable ({error}); {INSTALL_ROS}, or run with --direct, which needs none"
        ) from error
    return run_through_ros


def _run(
    run: Run,
    options: RunOptions,
    stop: StopRequest,
    console: Console,
    drawing: Drawing,
    observers: Sequence[Observer],
) -> RunResult:
    config = options.config
    for flag, path in (("--summary", options.summary), ("--report", options.report)):
        if path is not None:
            check_target(flag, path)
    for note in config.world().notes if is_terrain_file(config.terrain) else ():
        console.print(f"{config.terrain}: {note}", soft_wrap=True, highlight=False)
    config.check_world()
    drawing.prepare(config)
    with RunProgress(console, f"{robot_name(config.robot)} on {config.terrain}", config.duration) as bar:
        show = bar.show if console.is_terminal else None
        return run(config, options.ros, stop, show, (drawing, *observers))


def _report(result: RunResult, summary: Path | None, stop: StopRequest, console: Console) -> int:
    """Prints and writes what a run came to; returns the exit code."""
    print_summary(console, result)
    complaints = [result.failure] if result.failure is not None else []
    if result.lost:
        lost = ", ".join(f"{c.lost} of {t}" for t, c in result.topics.items() if c.lost)
        complaints.append(f"messages were lost: {lost}")
    log_manifest = None if result.log_path is None else result.log_path.with_suffix(".json")
    for path in filter(None, (log_manifest, summary)):
        try:
            write_manifest(result, path)
        except HarnessError as error:  # noqa: PERF203 - two files at most
            complaints.append(str(error))
    for complaint in complaints:
        print(f"harness.run: {complaint}", file=sys.stderr)
    return 1 if complaints else stop.exit_code


def _draw(drawing: Drawing, stop: StopRequest, console: Console) -> None:
    """Draws, which takes its time: whoever ended the run from outside is not kept waiting."""
    if drawing.wanted and stop.name in ("SIGTERM", HANGUP):
        print(f"harness.run: nothing was drawn: stopped by {stop.name}", file=sys.stderr)
        return
    if drawing.wanted and stop.signal is not None:
        console.print("drawing what there is; Ctrl-C again leaves it out", highlight=False)
    if not drawing.wanted:
        return
    with counted(console, "drawing") as show:
        drawn = drawing.finish(show)
    for path in drawn:
        console.print(f"drawn: {path}", soft_wrap=True, highlight=False)


if __name__ == "__main__":
    sys.exit(main())
