"""Command: drive a rover over a terrain and log its traversal metrics.

    python -m harness.run --terrain rocky --robot leo --seed 0

Parses, calls, prints; the work is in harness.ros.session (through ROS) and harness.direct (without).
"""

import argparse
import importlib
import signal
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

if __name__ == "__main__":  # what follows takes a second to load; Ctrl-C must not show where it was
    signal.signal(signal.SIGINT, signal.SIG_DFL)

from rich.console import Console

from harness import __version__, headless
from harness.command_line import OneLineParser
from harness.config import Batch, EpisodeConfig
from harness.console import RunProgress, print_choices, print_summary
from harness.drivers import DRIVERS
from harness.errors import HarnessError, UsageError
from harness.extended import extended_ros_args
from harness.interrupt import StopRequest
from harness.manifest import check_writable, write_manifest
from harness.report import RunReport
from harness.result import Progress, RunResult
from harness.robots import ROVERS, find_rover
from harness.sensors.fault_kinds import describe_faults
from harness.sensors.fault_spec import FORM
from harness.sensors.noise import DEFAULT_PRESET, PRESETS
from harness.view.drawing import Drawing
from harness.world.dem import is_terrain_file

DEFAULT_LOG_DIR = Path("metrics_analyzer/data/metric_logs")
SLOWEST_RATE = 0.01


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; returns its exit code."""
    words, ros_args = _split_ros_args(sys.argv[1:] if arguments is None else arguments)
    options = _parser().parse_args(words)
    console = Console()
    if options.list:
        print_choices(console)
        return 0
    try:
        drawing = Drawing(
            options.picture,
            options.video,
            lidar=options.picture_lidar,
            backend=headless.REQUESTED,
        )
        report = RunReport(options.report)
        _load(options)
        with StopRequest() as stop, drawing:
            result = _run(options, ros_args, stop, console, drawing, report)
            result = replace(result, report=options.report)
            exit_code = _report(result, options.summary, stop, console)
            if (page := report.write(result)) is not None:
                console.print(f"report: {page}", soft_wrap=True, highlight=False)
            _draw(drawing, stop, console)
    except HarnessError as error:
        print(f"harness.run: {error}", file=sys.stderr)
        return error.exit_code
    return exit_code


def _load(options: argparse.Namespace) -> None:
    """Loads what only these options need: MuJoCo and compiled kernels.

    Not with this module: through ROS, only the process that simulates needs them. Not later: a signal
    would then be raised in the midst of modules that are not prepared for it.
    """
    if options.direct:
        importlib.import_module("harness.direct")
    if options.report is not None:
        importlib.import_module("harness.report.page")


def _run(
    options: argparse.Namespace,
    ros_args: Sequence[str],
    stop: StopRequest,
    console: Console,
    drawing: Drawing,
    report: RunReport,
) -> RunResult:
    config = _config(options)
    config.validate()
    _check_combination(options, ros_args)
    if options.summary is not None:
        check_writable(options.summary)
    report.prepare()
    for note in config.world().notes if is_terrain_file(config.terrain) else ():
        console.print(f"{config.terrain}: {note}", soft_wrap=True, highlight=False)
    drawing.prepare(config)

    def watch(batch: Batch) -> None:
        drawing.watch(batch)
        report.watch(batch)

    title = f"{config.robot} on {config.terrain}"
    with RunProgress(console, title, config.duration) as bar:
        if options.direct:
            from harness.direct import run_direct  # noqa: PLC0415 - see _load

            return run_direct(
                *(config, options.log_dir, options.rate, stop, bar.show, watch),
                extended=options.extended,
            )
        return _run_through_ros(options, config, ros_args, stop, bar.show, watch)


def _run_through_ros(
    options: argparse.Namespace,
    config: EpisodeConfig,
    ros_args: Sequence[str],
    stop: StopRequest,
    show: Callable[[Progress], None],
    watch: Callable[[Batch], None],
) -> RunResult:
    # The only import of rclpy on this side of harness.ros: --direct must work where there is none.
    try:
        from harness.ros.session import RosOptions, run_through_ros  # noqa: PLC0415
    except ImportError as error:
        message = (
            f"ROS 2 is not importable ({error}); install the extra with pip install -e '.[ros]', "
            "source a ROS 2 installation, or run with --direct, which needs none"
        )
        raise UsageError(message) from error
    ros = RosOptions(
        log_dir=options.log_dir,
        host_metrics=not options.no_metrics,
        wait_for=tuple(options.wait_for),
        rate=options.rate,
        ros_args=[
            *_namespace_args(options.namespace),
            *(extended_ros_args(find_rover(config.robot)) if options.extended else ()),
            *ros_args,
        ],
        record=options.record,
    )
    return run_through_ros(config, ros, stop, show, watch)


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


def _split_ros_args(words: Sequence[str]) -> tuple[list[str], list[str]]:
    """Separates `--ros-args ... [--]` from the command's own words, as ROS nodes do."""
    words = list(words)
    if "--ros-args" not in words:
        return words, []
    start = words.index("--ros-args")
    end = words.index("--", start) + 1 if "--" in words[start:] else len(words)
    return words[:start] + words[end:], words[start:end]


def _config(options: argparse.Namespace) -> EpisodeConfig:
    return EpisodeConfig(
        terrain=options.terrain,
        robot=options.robot,
        seed=options.seed,
        duration=options.duration,
        driver=options.driver,
        difficulty=options.difficulty,
        terrain_size=options.terrain_size,
        terrain_height=options.terrain_height,
        timestep=options.timestep,
        noise=options.noise,
        lidar_beams=options.lidar_beams,
        imu_rate=options.imu_rate,
        faults=tuple(options.fault),
    )


def _namespace_args(namespace: str) -> list[str]:
    """The ROS arguments that put every topic but /clock into a namespace."""
    name = namespace.strip("/")
    return ["--ros-args", "-r", f"__ns:=/{name}", "--"] if name else []


def _check_combination(options: argparse.Namespace, ros_args: Sequence[str]) -> None:
    if options.extended and options.no_metrics:
        raise UsageError(
            "--extended is for the hosted metrics_node; start yours with -p extended_columns:=true"
        )
    if not options.direct:
        return
    for given, flag in (
        (options.no_metrics, "--no-metrics"),
        (bool(options.wait_for), "--wait-for"),
        (bool(ros_args), "--ros-args"),
        (bool(options.namespace), "--namespace"),
        (options.record is not None, "--record"),
        (options.driver == "cmd_vel", "--driver cmd_vel"),
    ):
        if given:
            raise UsageError(f"{flag} needs ROS; leave out --direct")


def _rate(text: str) -> float | None:
    if text == "max":
        return None
    try:
        rate = float(text)
    except ValueError:
        rate = float("nan")
    if not SLOWEST_RATE <= rate < float("inf"):
        message = f"'{text}' is not valid; give 'max' or a number from {SLOWEST_RATE} up"
        raise argparse.ArgumentTypeError(message)
    return rate


class _WidthAndDepth(argparse.Action):
    """Takes two numbers, or one for both."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,  # noqa: ANN401 - as argparse has it
        option_string: str | None = None,
    ) -> None:
        if len(values) > 2:
            parser.error(f"argument {option_string}: give one or two numbers")
        setattr(namespace, self.dest, (values[0], values[-1]))


def _parser() -> argparse.ArgumentParser:
    defaults = EpisodeConfig()
    parser = OneLineParser(
        prog="python -m harness.run",
        description="Drives a rover over rough terrain, publishes its sensors as ROS 2 topics and "
        "logs traversal metrics to CSV.",
        epilog="Arguments after --ros-args go to ROS, e.g. --ros-args -r scan:=front/scan.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    world = parser.add_argument_group("episode")
    world.add_argument(
        "--terrain",
        default=defaults.terrain,
        metavar="NAME|FILE",
        help="see --list, or a heightmap: GeoTIFF, TIFF, PNG, .npy",
    )
    world.add_argument(
        "--terrain-size",
        type=float,
        nargs="+",
        action=_WidthAndDepth,
        metavar="M",
        help="side length, or width and depth, of a heightmap that does not say",
    )
    world.add_argument(
        "--terrain-height",
        type=float,
        metavar="M",
        help="relief, lowest to highest point, of a heightmap that does not say",
    )
    world.add_argument("--robot", default=defaults.robot, metavar="NAME", help=", ".join(ROVERS))
    world.add_argument("--driver", default=defaults.driver, metavar="NAME", help=", ".join(DRIVERS))
    world.add_argument("--seed", type=int, default=defaults.seed, metavar="N")
    world.add_argument(
        "--duration", type=float, default=defaults.duration, metavar="S", help="simulated seconds"
    )
    world.add_argument(
        "--difficulty", type=float, default=defaults.difficulty, metavar="D", help="0 to 1"
    )
    world.add_argument(
        "--timestep", type=float, default=defaults.timestep, metavar="S", help="physics step"
    )
    sensors = parser.add_argument_group("sensors")
    sensors.add_argument(
        "--noise",
        nargs="?",
        const=True,
        default=defaults.noise,
        metavar="NAME",
        help=f"sensor errors: {', '.join(PRESETS)}; {DEFAULT_PRESET} if not named",
    )
    sensors.add_argument("--lidar-beams", type=int, default=defaults.lidar_beams, metavar="N")
    sensors.add_argument("--imu-rate", type=int, default=defaults.imu_rate, metavar="HZ")
    faults = parser.add_argument_group("faults", describe_faults())
    faults.add_argument(
        "--fault",
        action="append",
        default=[],
        metavar="SPEC",
        help=f"{FORM}, in simulated seconds, e.g. imu:nan@10+2; repeatable",
    )
    run = parser.add_argument_group("run")
    run.add_argument(
        "--rate", type=_rate, default=None, metavar="R|max", help="times real time; max by default"
    )
    run.add_argument("--log-dir", type=Path, default=DEFAULT_LOG_DIR, metavar="DIR")
    run.add_argument(
        "--namespace", default="", metavar="NAME", help="of all topics but /clock, e.g. rover1"
    )
    run.add_argument("--no-metrics", action="store_true", help="publish only; host no metrics_node")
    run.add_argument("--direct", action="store_true", help="no ROS: samples go straight to the CSV")
    run.add_argument(
        "--extended",
        action="store_true",
        help="log the extended columns too (docs/metrics.md), with the rover's footprint",
    )
    run.add_argument(
        "--wait-for",
        action="append",
        default=[],
        metavar="NODE",
        help="keep lock-step with a node in another process; repeatable",
    )
    run.add_argument(
        "--record",
        type=Path,
        metavar="FILE.mcap",
        help="record every published topic; a killed run's file is read by rover_metrics.replay as it "
        "is, and mended by: mcap recover FILE.mcap -o MENDED.mcap",
    )
    run.add_argument(
        "--report", type=Path, metavar="FILE.html", help="write a page about the run: map, plots, truth"
    )
    run.add_argument("--summary", type=Path, metavar="FILE.json", help="write the manifest there")
    pictures = parser.add_argument_group("pictures")
    pictures.add_argument(
        "--picture", type=Path, metavar="FILE.png", help="draw the rover at the end of its path"
    )
    pictures.add_argument(
        "--video", type=Path, metavar="FILE.mp4", help="draw the run in at most 10 s (extra [video])"
    )
    pictures.add_argument("--picture-lidar", action="store_true", help="show the lidar's beams in them")
    parser.add_argument("--list", action="store_true", help="print terrains, robots, drivers and noise")
    parser.add_argument("--version", action="version", version=f"rover-harness {__version__}")
    return parser


if __name__ == "__main__":
    sys.exit(main())
