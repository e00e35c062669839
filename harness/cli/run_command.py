"""What harness.run does: drives, shows progress and summary, writes files.

The drive is in harness.ros.session (through ROS) and harness.episode.direct (without).
"""

import argparse
import importlib
import shlex
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from harness.base.edge import loading
from harness.base.errors import UsageError, needing_ros
from harness.base.files import BESIDE, PAGES, check_target, write_whole
from harness.base.interrupt import HANGUP, StopRequest
from harness.base.opengl import keep_opengl_out
from harness.cli.console import counted, driving, next_step, print_choices, print_summary
from harness.cli.options import RunOptions, run_options, with_name
from harness.episode.assembly import actor_names, check_world, world_of
from harness.episode.helm import Helm
from harness.episode.loop import Observer
from harness.episode.manifest import write_manifest
from harness.episode.mishaps import mishaps
from harness.episode.result import Drive, Outputs, RunResult, steered
from harness.episode.social_recorder import SocialRecorder
from harness.page.run.recorder import RunRecorder, Stretch
from harness.robots import robot_name
from harness.view.drawing import SUFFIXES, Drawing
from harness.view.live import load_page, watched
from harness.world.files import is_terrain_file
from rover_metrics.errors import complain, sibling
from rover_metrics.sheet.console import PlainConsole

OUTSIDE = ("SIGTERM", HANGUP)  # a run that ends by these waits for no picture


def run_command(given: argparse.Namespace, ros_args: Sequence[str], words: Sequence[str]) -> int:
    """Does what the options of a command line ask for; returns the exit code.

    Args:
        given: The options.
        ros_args: The words for ROS.
        words: All of the line, for who wants to repeat the run.
    """
    console = PlainConsole()
    if given.list:
        print_choices(console)
        return 0
    options = run_options(given, ros_args)
    options = replace(options, command=_command_line(words, options.live.live_token))
    with _folder(options.ros.log_dir):
        return _command(options, console)


def _command_line(words: Sequence[str], token: str) -> str:
    """What repeats the run, without the word that lets others steer it."""
    line = f"{sibling('harness.run')} {shlex.join(words)}".rstrip()
    return line.replace(token, "TOKEN") if token else line


@contextmanager
def _folder(logs: Path) -> Iterator[None]:
    """Makes the folder of the logs, in which files may be named; takes it back where it stays empty."""
    made = [each for each in (logs, *logs.parents) if not each.exists()]
    for each in reversed(made):
        with suppress(OSError):  # which is told by who writes there
            each.mkdir()
    try:
        yield
    finally:
        for each in made:
            with suppress(OSError):  # where something is in it, or it could not be made
                each.rmdir()


def _command(options: RunOptions, console: Console) -> int:
    run = options.run
    backend = keep_opengl_out()  # before MuJoCo is loaded
    files = options.files
    drawing = Drawing(
        files.picture, files.video, lidar=files.picture_lidar, backend=backend, camera=files.camera
    )
    recorders = [RunRecorder() for _ in run.rovers] if files.page is not None else []
    logs = _social(options)
    with loading():
        drive = _loaded(options)
    with StopRequest() as stop, drawing, ExitStack() as at_end:
        drawn = _prepared(options, console, drawing)
        live = watched(run, options.live, options.ros.rate, stop)
        helm, watching = at_end.enter_context(live)
        outputs = options.outputs(logs, drawn, recorders, watching)
        driven = _drive(drive, options, outputs, stop, console, helm)
        if helm is not None and helm.note(run):  # no line gives again what somebody has ordered
            options = replace(options, command="")
        results = [
            _placed(result, options, output) for result, output in zip(driven, outputs, strict=True)
        ]
        for number, log in enumerate(logs):
            log.close()
            results[number] = replace(results[number], social_log=log.path)
        exit_code = _report(results, options, stop, console)
        if stop.name not in OUTSIDE:
            drawing.begin(_log(results[0], outputs[0]))  # beside the page, on another processor
        for result, recorder in zip(results, recorders, strict=False):
            others = {
                other.rover.name: each.track
                for other, each in zip(results, recorders, strict=True)
                if other is not result
            }
            _write_page(result, recorder, others, console)
        _draw(drawing, stop, console)
        if recorders or drawing.wanted:
            console.print(f"next: {next_step(results)}", soft_wrap=True)
    return exit_code


def _log(result: RunResult, output: Outputs) -> Path:
    """The log of a rover, beside which other files stand; where it would be if there is none."""
    return result.log_path or output.log_dir / "run.csv"


def _placed(result: RunResult, options: RunOptions, output: Outputs) -> RunResult:
    """The result with the place of its page, and failed if it came to what --fail-on names."""
    beside, page = _log(result, output).with_suffix(".html"), options.files.page
    wrong = mishaps(result, options.files.fail_on)
    failure = result.failure or (wrong[0].text if wrong else None)
    return replace(
        result,
        command=options.command,
        report=beside if page == BESIDE else with_name(page, result.rover),
        params=options.params,
        columns=output.settings.extended.column_names,
        failure=failure,
    )


def _write_page(
    result: RunResult, recorder: RunRecorder, others: Mapping[str, Sequence[Stretch]], console: Console
) -> None:
    from harness.page.run.content import render  # noqa: PLC0415 - see `_loaded`

    assert result.report is not None  # noqa: S101 - there is a recorder
    with console.status("drawing the page"):
        result.report.parent.mkdir(parents=True, exist_ok=True)  # of a run without a log
        write_whole(result.report, render(result, recorder, others), "the page")
    console.print(f"page: {result.report}", soft_wrap=True)


def _social(options: RunOptions) -> list[SocialRecorder]:
    """What keeps the social log of each rover among people, none without; UsageError if it cannot."""
    names, file = actor_names(options.run.world), options.files.social_log
    if file is not None:
        check_target("--social-log", file, ".csv")
    folders = [options.log_dir(rover) for rover in options.run.rovers] if names else []
    overwrite = options.ros.overwrite
    return [SocialRecorder(names, file, folder, overwrite=overwrite) for folder in folders]


def _loaded(options: RunOptions) -> Drive:
    """Returns what drives the run, with what only these options need: ROS, MuJoCo, compiled kernels.

    Not with this module: through ROS, the latter are loaded while nodes are discovered, and --direct
    must work where there is no rclpy. Not later: a signal would then be raised in the midst of modules
    that are not prepared for it.

    Raises:
        UsageError: ROS 2 is missing.
    """
    if options.files.page is not None:
        importlib.import_module("harness.page.run.content")
    load_page(options.live)
    if options.direct:
        from harness.episode.direct import run_direct  # noqa: PLC0415

        return run_direct
    with needing_ros(", or run with --direct, which needs none"):
        from harness.ros.session import run_through_ros  # noqa: PLC0415
    return run_through_ros


def _prepared(options: RunOptions, console: Console, drawing: Drawing) -> Sequence[Observer]:
    """Checks what can be checked before the run; returns what keeps each rover's states, if any does."""
    run = options.run
    for flag, path, ends in (
        ("--json", options.files.summary, ()),
        ("--page", options.files.page, PAGES),
    ):
        if path is not None and path != BESIDE:
            check_target(flag, path, *ends)
    may_note = is_terrain_file(run.world.terrain) or run.world.actors
    for note in world_of(run).notes if may_note else ():
        console.print(f"{run.world.terrain}: {note}", soft_wrap=True)
    check_world(run)
    drawing.prepare(run)
    return drawing.observers


def _drive(
    drive: Drive,
    options: RunOptions,
    outputs: Sequence[Outputs],
    stop: StopRequest,
    console: Console,
    helm: Helm | None,
) -> tuple[RunResult, ...]:
    run = options.run
    robots = " and ".join(robot_name(rover.robot) for rover in run.rovers)
    with driving(console, f"{robots} on {run.world.terrain}", run.duration) as show:
        results = drive(run, outputs, options.ros, stop, show, helm)
    return tuple(steered(result, helm) for result in results)


def _report(
    results: Sequence[RunResult], options: RunOptions, stop: StopRequest, console: Console
) -> int:
    """Prints and writes what a run came to; returns the exit code."""
    complaints = dict.fromkeys(result.failure for result in results if result.failure is not None)
    for result in results:
        if result.rover.name:
            console.rule(f"{result.rover.name}, a {robot_name(result.rover.robot)}", align="left")
        print_summary(console, result)
        if result.lost:
            lost = ", ".join(f"{c.lost} of {t}" for t, c in result.topics.items() if c.lost)
            complaints[f"messages were lost: {lost}"] = None
        log_manifest = None if result.log_path is None else result.log_path.with_suffix(".json")
        summary = with_name(options.files.summary, result.rover)
        for path in filter(None, (log_manifest, summary)):
            try:
                write_manifest(result, path)
            except UsageError as error:  # noqa: PERF203 - two files at most
                if result.failure is None or path == summary:  # a full disk is reported once
                    complaints[str(error)] = None
    for complaint in complaints:
        complain("harness.run", complaint)
    return 1 if complaints else stop.exit_code


def _draw(drawing: Drawing, stop: StopRequest, console: Console) -> None:
    """Draws, which takes its time: a run that was ended from outside does not wait for it."""
    if drawing.wanted and stop.name in OUTSIDE:
        complain("harness.run", f"nothing was drawn: stopped by {stop.name}")
        return
    if drawing.wanted and stop.signal is not None:
        console.print("drawing what there is; Ctrl-C again leaves it out")
    if drawing.lack:
        console.print(drawing.lack, soft_wrap=True)
    if not drawing.wanted or drawing.lack:
        return
    with counted(console, "drawing") as show:
        drawn = drawing.finish(show)
    for path in drawn:
        kind = "picture" if path.suffix == SUFFIXES["--picture"] else "video"
        console.print(f"{kind}: {path}", soft_wrap=True)
