"""What the command line of harness.run asks for, as one value."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from harness.base.errors import UsageError, find_named
from harness.base.ros_names import namespace_of
from harness.cli.files import Files
from harness.cli.flags import flags_of, from_flags
from harness.cli.run_parser import DEFAULT_LOG_DIR, parsed
from harness.drivers import takes_goals
from harness.episode.assembly import check, fleet, people
from harness.episode.loop import Observer
from harness.episode.metrics_feed import metric_settings
from harness.episode.result import Outputs
from harness.spec.fleet import parse_rovers
from harness.spec.live import NOWHERE, LiveOptions
from harness.spec.ros import FrameOptions, RosOptions
from harness.spec.rover import CMD_VEL, RoverSetup
from harness.spec.run import PARTS, Run, from_fields
from rover_metrics.errors import ParameterError
from rover_metrics.extended.further import FURTHER
from rover_metrics.extended.parameter_file import read_values
from rover_metrics.extended.settings import Settings


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What the command line of harness.run asks for.

    Attributes:
        run: What is driven, checked.
        ros: How it goes through ROS; `log_dir` and `rate` hold for a run without it too.
        direct: Whether it does without ROS.
        settings: Of each rover's metrics.
        params: The file that they come from; None without.
        files: What is left behind beside the log.
        live: Where it can be watched meanwhile.
        command: The line that asks for it, for the record beside the log.
    """

    run: Run
    ros: RosOptions
    direct: bool
    settings: tuple[Settings, ...]
    params: Path | None
    files: Files
    live: LiveOptions = NOWHERE
    command: str = ""

    def log_dir(self, rover: RoverSetup) -> Path:
        """Returns the folder of a rover's logs: with its name, if there are several."""
        return self.ros.log_dir / rover.name

    def outputs(self, *observers: Sequence[Observer]) -> list[Outputs]:
        """Returns where each rover's data go; each group of observers has one per rover, or none."""
        return [
            Outputs(
                log_dir=self.log_dir(rover),
                observers=tuple(group[number] for group in observers if group),
                settings=self.settings[number],
            )
            for number, rover in enumerate(self.run.rovers)
        ]


def with_name(file: Path | None, rover: RoverSetup) -> Path | None:
    """Returns the file of one rover: with the rover's name in its own, if there are several."""
    return file.with_stem(f"{file.stem}_{rover.name}") if file is not None and rover.name else file


def parse_run(arguments: Sequence[str]) -> RunOptions | None:
    """Returns what the words of a command line ask for, None for the list of choices; or UsageError."""
    given, ros_args = parsed(arguments)
    return None if given.list else run_options(given, ros_args)


def run_options(given: argparse.Namespace, ros_args: Sequence[str]) -> RunOptions:
    """Returns what the options of a command line ask for; UsageError as of `parse_run`."""
    run, files, live = _run(given), from_flags(Files, given), from_flags(LiveOptions, given)
    log_dir = DEFAULT_LOG_DIR if files.out is None else files.out
    rate = 1.0 if "foxglove" in given else live.rate
    namespace = namespace_of(given.namespace)
    namespace_args = ("--ros-args", "-r", f"__ns:=/{namespace}", "--") if namespace else ()
    ros = from_flags(
        RosOptions,
        argparse.Namespace(**{"log_dir": log_dir, "rate": rate} | vars(given)),
        host_metrics=not given.no_metrics,
        ros_args=(*namespace_args, *ros_args),
        frames=from_flags(FrameOptions, given),
    )
    _check_combination(given, run, ros, files)
    spaces = [rover.name or namespace for rover in run.rovers]
    settings = tuple(_settings(given, run, number, spaces) for number in range(len(spaces)))
    return RunOptions(
        run=run,
        ros=ros,
        direct=given.direct,
        settings=settings,
        params=given.params,
        files=files.in_one_folder(),
        live=live,
    )


def _run(given: argparse.Namespace) -> Run:
    flags = flags_of(*PARTS.values(), Run)
    values = {name: value for name, value in vars(given).items() if name in flags}
    run = from_fields(Run(), values, name=lambda name: flags.get(name, name))
    if not given.rover:
        check(run)
        return run
    for name, is_given, mend in (
        ("social-log", "social_log" in given, "each --rover has its own below --log-dir; leave it out"),
        ("namespace", given.namespace, "name each as --rover ROBOT:NAME"),
        ("robot", "robot" in given, "give --rover ROBOT beside the others"),
    ):
        if is_given:
            raise UsageError(f"--{name} is for a single rover: {mend}")
    return fleet(run, parse_rovers(given.rover, run.rover))


def _settings(given: argparse.Namespace, run: Run, number: int, spaces: Sequence[str]) -> Settings:
    """The settings of a rover's metrics, whose nodes are in these namespaces."""
    try:
        values = read_values(given.params, spaces[number], spaces) if given.params else {}
    except ParameterError as error:
        raise UsageError(f"--params: {error}") from error
    values |= {"columns": given.columns} if given.columns else {}
    for name in filter(None, values.get("columns", "").split(",")):
        find_named("columns", name, FURTHER)
    return metric_settings(run, values, number, extended=given.extended or bool(given.columns))


def _check_combination(given: argparse.Namespace, run: Run, ros: RosOptions, files: Files) -> None:
    if given.params is not None and given.no_metrics:
        raise UsageError(
            "--params is for the hosted metrics_node; start yours with --ros-args --params-file FILE"
        )
    if (given.extended or given.columns) and given.no_metrics:
        raise UsageError(
            "--extended is for the hosted metrics_node; start yours with -p extended_columns:=true"
        )
    if any(word.partition(":=")[0].rpartition(":")[2] == "log_dir" for word in ros.ros_args):
        raise UsageError("log_dir does not count behind --ros-args; give --log-dir FOLDER before it")
    if "soil" in given and not run.world.soil:
        raise UsageError("--soil '' names no soil; leave it out for rigid ground, or see --list")
    if run.world.keep_ruts and not run.world.soil:
        raise UsageError("--keep-ruts is of soil; name one with --soil, or leave it out")
    if files.out is not None and "log_dir" in given:
        raise UsageError("--out is the folder of the log too; leave out --log-dir")
    if ros.overwrite and ros.record is None and files.social_log is None:
        message = "--overwrite is for the file of --record or --social-log; name one, or leave it out"
        raise UsageError(message)
    if files.social_log is not None and not people(run.world):
        raise UsageError("--social-log is of a run with people; add --actor SPEC, or leave it out")
    if given.direct:
        _check_direct(given, run, ros)


def _check_direct(given: argparse.Namespace, run: Run, ros: RosOptions) -> None:
    """Checks that nothing needs ROS, and that no driver waits for what only ROS brings."""
    for is_given, flag in (
        (given.no_metrics, "--no-metrics"),
        (bool(ros.wait_for), "--wait-for"),
        (bool(ros.wait_for_topic), "--wait-for-topic"),
        (bool(ros.ros_args) and not given.namespace, "--ros-args"),
        (bool(given.namespace), "--namespace"),
        (ros.cmd_vel != "auto", "--cmd-vel"),
        (ros.truth_map, "--truth-map"),
    ):
        if is_given:
            raise UsageError(f"{flag} needs ROS; leave out --direct")
    if ros.frames != FrameOptions() and ros.record is None and ros.foxglove is None:
        flag = "--map-tf" if ros.frames.map_tf else "--odom-tf"
        raise UsageError(f"{flag} is of /tf, which nobody gets; leave out --direct, or give --record")
    for rover in run.rovers:
        waits = takes_goals(rover.driver) and rover.goal_area is None and run.plan.route is None
        if waits or rover.driver == CMD_VEL:
            without = " without --route or --goal-area" if waits else ""
            raise UsageError(f"--driver {rover.driver}{without} needs ROS; leave out --direct")
