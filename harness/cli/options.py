"""What the command line of harness.run asks for, as one value."""

import argparse
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, TypeVar

from harness.cli.run_parser import run_parser
from harness.config import EpisodeConfig, RosOptions
from harness.drivers import takes_goals
from harness.episode.metrics_feed import extended_ros_args, extended_settings, parameter_words
from harness.errors import UsageError
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
        config: The episode, not checked yet.
        ros: How it goes through ROS; `log_dir` and `rate` hold for a run without it too.
        direct: Whether it does without ROS.
        settings: Of the metrics; the hosted node gets them as parameters.
        params: The file that they come from; None without.
        report: Page to write about the run; None for none. Likewise `summary`, `picture`, `video`.
        picture_lidar: Whether pictures show the beams.
        social_log: The log of a run with people; None for one in `log_dir`.
    """

    config: EpisodeConfig
    ros: RosOptions
    direct: bool
    settings: Settings
    params: Path | None
    report: Path | None
    summary: Path | None
    picture: Path | None
    video: Path | None
    picture_lidar: bool
    social_log: Path | None


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
    namespace = given.namespace.strip("/")
    namespace_args = ("--ros-args", "-r", f"__ns:=/{namespace}", "--") if namespace else ()
    values = read_parameters(given.params) if given.params else {}
    settings, extended_args = Settings(), list[str]()
    if given.extended:
        of_run = extended_settings(find_rover(config.robot), config.gravity())
        settings = replace(settings, extended_columns=True, extended=of_run)
        extended_args = extended_ros_args(of_run)
    ros = _filled(
        RosOptions,
        given,
        host_metrics=not given.no_metrics,
        wait_for=tuple(given.wait_for),
        ros_args=(*namespace_args, *extended_args, *parameter_words(values), *ros_args),
        frames=_filled(FrameOptions, given),
    )
    return _filled(RunOptions, given, config=config, ros=ros, settings=settings.updated(values))


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
        (options.driver == "cmd_vel", "--driver cmd_vel"),
        (
            takes_goals(options.driver) and options.goal_area is None,
            f"--driver {options.driver} without --goal-area",
        ),
    ):
        if given:
            raise UsageError(f"{flag} needs ROS; leave out --direct")
