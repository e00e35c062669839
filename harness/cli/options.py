"""What the command line of harness.run asks for, as one value."""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

from harness.base.errors import UsageError
from harness.cli.run_parser import run_parser
from harness.config import CMD_VEL, EpisodeConfig, RosOptions
from harness.drivers import takes_goals
from harness.episode.fleet import fleet_of_words
from harness.episode.metrics_feed import extended_parameters, extended_settings, parameter_words
from harness.frames.options import FrameOptions
from harness.robots import find_rover
from harness.world.actors.spec import of_terrain
from rover_metrics.errors import ParameterError
from rover_metrics.extended.parameter_file import read_values
from rover_metrics.extended.settings import Settings
from rover_metrics.ros.arguments import complaint, split_ros_args

T = TypeVar("T")


@dataclass(frozen=True, kw_only=True)
class RunOptions:
    """What the command line of harness.run asks for.

    Attributes:
        fleet: The episode of each rover, not checked yet; `config` is the first one's.
        ros: How it goes through ROS; `log_dir` and `rate` hold for a run without it too.
        direct: Whether it does without ROS.
        all_settings: Of each rover's metrics; hosted nodes get them as parameters.
        parameters: Of each rover's hosted node, beside those in the arguments of `ros`.
        params: The file that they come from; None without.
        report: Page to write about the run; None for none. Likewise `summary`, `picture`, `video`.
        picture_lidar: Whether pictures show the beams.
        social_log: The log of a run with people; None for one in `log_dir`.
    """

    fleet: tuple[EpisodeConfig, ...]
    ros: RosOptions
    direct: bool
    all_settings: tuple[Settings, ...]
    parameters: tuple[Mapping[str, Any], ...]
    params: Path | None
    report: Path | None
    summary: Path | None
    picture: Path | None
    video: Path | None
    picture_lidar: bool
    social_log: Path | None

    @property
    def config(self) -> EpisodeConfig:
        """The first rover's episode."""
        return self.fleet[0]

    def log_dir(self, config: EpisodeConfig) -> Path:
        """Returns the folder of a rover's logs: with its name, if there are several."""
        return self.ros.log_dir / config.name

    def report_of(self, config: EpisodeConfig) -> Path | None:
        """Returns a rover's page: FILE_NAME.html, if there are several."""
        return _with_name(self.report, config)

    def summary_of(self, config: EpisodeConfig) -> Path | None:
        """Returns a rover's manifest, likewise."""
        return _with_name(self.summary, config)

    @property
    def settings(self) -> Settings:
        """Those of the first rover's metrics."""
        return self.all_settings[0]


def _with_name(file: Path | None, config: EpisodeConfig) -> Path | None:
    if file is None or not config.name:
        return file
    return file.with_stem(f"{file.stem}_{config.name}")


def parse_run(arguments: Sequence[str]) -> RunOptions | None:
    """Returns what the words of the command line ask for; None if it is the list of choices.

    Raises:
        UsageError: Two options exclude each other; the message names the mend.
    """
    words, ros_args = split_ros_args(arguments)
    parser = run_parser()
    wrong = complaint(ros_args, parser._option_string_actions)  # noqa: SLF001 - all of its options
    if wrong is not None:
        raise UsageError(wrong)
    given = parser.parse_args(words)
    if given.terrain_size is not None:
        if len(given.terrain_size) > 2:
            parser.error("argument --terrain-size: give one or two numbers")
        given.terrain_size = given.terrain_size[0], given.terrain_size[-1]
    if given.list:
        return None
    _check_combination(given, ros_args)
    config = _filled(EpisodeConfig, given, faults=tuple(given.fault), actors=tuple(given.actor))
    fleet = fleet_of_words(given.rover, config) if given.rover else (config,)
    if given.direct:
        _check_drivers(fleet)
    namespace = given.namespace.strip("/")
    namespace_args = ("--ros-args", "-r", f"__ns:=/{namespace}", "--") if namespace else ()
    values = read_parameters(given.params) if given.params else {}
    made = [_settings(each, extended=given.extended) for each in fleet]
    told = [extended_parameters(each.extended) if given.extended else {} for each in made]
    # Of several nodes each must be told of its own; of a single one, what follows in the arguments wins.
    extended_args = [] if given.rover else parameter_words(told[0])
    ros = _filled(
        RosOptions,
        given,
        host_metrics=not given.no_metrics,
        wait_for=tuple(given.wait_for),
        ros_args=(*namespace_args, *extended_args, *parameter_words(values), *ros_args),
        frames=_filled(FrameOptions, given),
    )
    settings = tuple(each.updated(values) for each in made)
    parameters = tuple(each | values for each in told) if given.rover else ({},)
    return _filled(RunOptions, given, fleet=fleet, ros=ros, all_settings=settings, parameters=parameters)


def _settings(config: EpisodeConfig, *, extended: bool) -> Settings:
    """The settings of a rover's metrics, but for those of a file."""
    if not extended:
        return Settings()
    of_run = extended_settings(find_rover(config.robot), config.gravity())
    return replace(Settings(), extended_columns=True, extended=of_run)


def read_parameters(path: Path) -> dict[str, Any]:
    """Returns the parameters of metrics_node that a file sets, by name.

    Raises:
        UsageError: It cannot be read, or something in it is not valid.
    """
    try:
        return read_values(path)
    except ParameterError as error:
        raise UsageError(f"--params: {error}") from error


def _filled(cls: type[T], given: argparse.Namespace, **others: object) -> T:
    """A dataclass of the options of its fields' names, and of others."""
    names = [item.name for item in fields(cls)]  # type: ignore[arg-type]  # a dataclass
    return cls(**{name: getattr(given, name) for name in names if name in given} | others)


def _check_combination(options: argparse.Namespace, ros_args: Sequence[str]) -> None:
    if options.params is not None and options.no_metrics:
        raise UsageError(
            "--params is for the hosted metrics_node; start yours with --ros-args --params-file FILE"
        )
    if options.extended and options.no_metrics:
        raise UsageError(
            "--extended is for the hosted metrics_node; start yours with -p extended_columns:=true"
        )
    if options.overwrite and options.record is None:
        raise UsageError("--overwrite is for the file of --record; name one, or leave it out")
    if options.social_log is not None and not (
        options.actor or of_terrain(options.terrain, options.resource_path)
    ):
        raise UsageError("--social-log is of a run with people; add --actor SPEC, or leave it out")
    _check_fleet(options)
    if not options.direct:
        return
    for given, flag in (
        (options.no_metrics, "--no-metrics"),
        (bool(options.wait_for), "--wait-for"),
        (bool(ros_args), "--ros-args"),
        (bool(options.namespace), "--namespace"),
        (options.record is not None, "--record"),
        (options.odom_tf != FrameOptions.odom_tf, "--odom-tf"),
        (options.odom_tf_3d, "--odom-tf-3d"),
        (options.map_tf, "--map-tf"),
    ):
        if given:
            raise UsageError(f"{flag} needs ROS; leave out --direct")


def _check_fleet(options: argparse.Namespace) -> None:
    """Checks that what is told of a single rover is not told of several."""
    wrong, flags = (
        "is for a single rover",
        {"social_log": None, "namespace": "", "robot": EpisodeConfig.robot},
    )
    mends = {
        "social_log": "each --rover has its own below --log-dir; leave it out",
        "namespace": "name each as --rover ROBOT:NAME",
        "robot": f"give --rover {options.robot} beside the others",
    }
    for name, default in flags.items():
        if options.rover and getattr(options, name) != default:
            raise UsageError(f"--{name.replace('_', '-')} {wrong}: {mends[name]}")


def _check_drivers(fleet: Sequence[EpisodeConfig]) -> None:
    """Checks that no driver waits for what only ROS brings."""
    for config in fleet:
        waits = takes_goals(config.driver) and config.goal_area is None
        if waits or config.driver == CMD_VEL:
            without = " without --goal-area" if waits else ""
            raise UsageError(f"--driver {config.driver}{without} needs ROS; leave out --direct")
