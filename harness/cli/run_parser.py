"""The options of harness.run: those of the values that it makes, and those of the command alone."""

import argparse
from collections.abc import Sequence
from pathlib import Path

from harness.base.version import __version__
from harness.cli.files import Files
from harness.cli.flags import add_flags
from harness.drivers import DRIVERS
from harness.faults.lookup import describe_faults
from harness.robots import ROVERS
from harness.sensors.noise import PRESETS
from harness.sensors.table import OPTIONAL
from harness.spec.fleet import FORM as ROVER_FORM
from harness.spec.fleet import KEYS
from harness.spec.live import LiveOptions
from harness.spec.plan import Plan
from harness.spec.ros import FrameOptions, RosOptions
from harness.spec.rover import DEFAULT_NOISE, RoverSetup
from harness.spec.run import Run
from harness.spec.world import WorldSpec
from rover_metrics.extended.settings import Settings
from rover_metrics.parser import OneLineParser
from rover_metrics.ros.arguments import parsed_beside_ros

DEFAULT_LOG_DIR = Path(Settings().log_dir)
ON_WHEELS = ("actuators", "surface")
IN_SENSORS = ("noise", "lidar_beams", "imu_rate", "sensors")
IN_RUN = ("log_dir", "rate", "wait_for", "wait_for_topic", "record", "overwrite", "truth_map")


def _choices() -> dict[str, str]:
    """The help of fields whose valid names stand in tables."""
    return {
        "robot": f"{', '.join(ROVERS)}, or a folder (docs/robots.md)",
        "driver": f"{', '.join(DRIVERS)}, or policy:FILE.npz (docs/gym.md)",
        "noise": f"sensor errors: {', '.join(PRESETS)}; {DEFAULT_NOISE} if not named; default: none",
        "sensors": f"optional ones, NAME or NAME=PRESET: none, {', '.join(OPTIONAL.shipped)}, names in "
        "rover.yaml (docs/sensors.md); default: those of rover.yaml",
    }


def parsed(arguments: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """Returns the options of the command line, and the words for ROS; leaves if one is not valid."""
    return parsed_beside_ros(run_parser(), arguments)


def run_parser() -> OneLineParser:
    """Parses everything but what comes after --ros-args."""
    parser = OneLineParser(
        prog="python -m harness.run",
        description="Drives a rover over rough terrain, publishes its sensors as ROS 2 topics and "
        "logs traversal metrics to CSV.",
        epilog="Arguments after --ros-args go to ROS, e.g. --ros-args -r scan:=front/scan.",
    )
    choices = _choices()
    episode = parser.add_argument_group("episode")
    add_flags(episode, WorldSpec)
    about = (
        f"several in one world, {ROVER_FORM}, each in its NAME's namespace; KEYs: {', '.join(KEYS)}; "
        "all other options hold for all of them (docs/fleets.md)"
    )
    episode.add_argument("--rover", action="append", default=[], metavar="SPEC", help=about)
    add_flags(episode, RoverSetup, ("robot", *ON_WHEELS, "start", "driver", "goal_area"), choices)
    add_flags(episode, Plan, ("route",))
    add_flags(episode, Run)
    add_flags(parser.add_argument_group("sensors"), RoverSetup, IN_SENSORS, choices)
    add_flags(parser.add_argument_group("faults", describe_faults()), RoverSetup, ("faults",))
    _add_run(parser.add_argument_group("run"))
    live = parser.add_argument_group("live")
    add_flags(live, LiveOptions)
    add_flags(live, RosOptions, ("foxglove",))
    add_flags(parser.add_argument_group("frames"), FrameOptions)
    commands = parser.add_argument_group("commands of --driver cmd_vel")
    add_flags(commands, RosOptions, ("cmd_vel",))
    add_flags(commands, RoverSetup, ("cmd_vel_timeout",))
    add_flags(
        parser.add_argument_group("pictures"), Files, ("picture", "video", "picture_lidar", "camera")
    )
    parser.add_argument("--list", action="store_true", help="print terrains, soils, robots and drivers")
    parser.add_argument("--version", action="version", version=f"rover-harness {__version__}")
    return parser


def _add_run(run: argparse._ArgumentGroup) -> None:
    run.add_argument(
        "--namespace", default="", metavar="NAME", help="of all topics but /clock, e.g. rover1"
    )
    run.add_argument("--no-metrics", action="store_true", help="publish only; host no metrics_node")
    run.add_argument("--direct", action="store_true", help="no ROS: samples go straight to the CSV")
    about = "log the extended columns too (docs/metrics.md), with the rover's footprint"
    run.add_argument("--extended", action="store_true", help=about)
    about = "further columns, of plug-ins (docs/extend.md), after the extended ones; default: none"
    run.add_argument("--columns", default="", metavar="NAME[,...]", help=about)
    about = "ROS parameter file (YAML) of metrics_node, with ROS or without: thresholds, columns"
    run.add_argument("--params", type=Path, metavar="FILE", help=about)
    text = f"{RosOptions.model_fields['log_dir'].description}; default: {DEFAULT_LOG_DIR}"
    add_flags(run, RosOptions, IN_RUN, {"log_dir": text})
    add_flags(run, Files, ("out", "page", "summary", "social_log", "fail_on"))
