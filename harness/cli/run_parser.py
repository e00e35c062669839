"""The options of harness.run: their names, types and help."""

import argparse
from collections.abc import Callable, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from harness import __version__
from harness.config import CMD_VEL_TYPES, EpisodeConfig
from harness.drivers import DRIVERS
from harness.drivers.goal_course import Area
from harness.episode.fleet import FORM as ROVER_FORM
from harness.episode.fleet import KEYS
from harness.faults.spec import FORM, describe_faults
from harness.frames.options import ODOM_SOURCES, FrameOptions
from harness.robots import ROVERS
from harness.sensors.choice import kinds
from harness.sensors.noise import DEFAULT_PRESET, PRESETS
from harness.world.actors.spec import Options as ActorOptions
from harness.world.solids.mesh_file import UNITS, UP
from harness.world.world import Start
from rover_metrics.errors import OneLineParser
from rover_metrics.extended.settings import Settings

DEFAULT_LOG_DIR = Path(Settings().log_dir)
SLOWEST_RATE = 0.01

Option = tuple[str, Callable[[str], Any], str, str]  # flag, type, metavar, help

EPISODE: tuple[Option, ...] = (
    ("--robot", str, "NAME|FOLDER", f"{', '.join(ROVERS)}, or a folder (docs/robots.md)"),
    ("--driver", str, "NAME", f"{', '.join(DRIVERS)}, or policy:FILE.npz (docs/gym.md)"),
    ("--seed", int, "N", "of everything random"),
    ("--duration", float, "S", "simulated seconds"),
    ("--difficulty", float, "D", "0 to 1"),
    ("--timestep", float, "S", "physics step"),
)
WORLDS: tuple[Option, ...] = (
    ("--resource-path", str, "DIR", "folder of an SDF world's models; repeatable; default: none"),
    ("--terrain-cell", float, "M", "distance of the heights that a mesh becomes; default: 0.1"),
    ("--mesh-unit", str, "NAME", f"unit of meshes: {', '.join(UNITS)}; default: as their files say"),
    ("--mesh-up", str, "AXIS", f"axis of meshes that is up: {', '.join(UP)}; default: likewise"),
    (
        "--rock-height",
        float,
        "M",
        "obstacles of files up to it are rocks; default: the rover's clearance",
    ),
    ("--rock", str, "PATTERN", "models that are rocks; repeatable; default: by height"),
    ("--hazard", str, "PATTERN", "models that are hazards; repeatable; default: by height"),
)
REPEATABLE = ("--resource-path", "--rock", "--hazard")
ACTOR_HELP = (
    "a person who walks; repeatable: NAME=X,Y/X,Y/... (way points), [NAME=]FILE.sdf (a trajectory, or "
    "actors of a world), NAME=random or NAME=social; behind it :KEY=VALUE,... of "
    f"{', '.join(item.name for item in fields(ActorOptions))} (docs/worlds.md)"
)
COMMANDS: tuple[Option, ...] = (
    ("--cmd-vel-timeout", float, "S", "stop S simulated seconds after the last command; off by default"),
)
SENSORS: tuple[Option, ...] = (
    ("--lidar-beams", int, "N", "beams of the lidar, all around"),
    ("--imu-rate", int, "HZ", "samples of the IMU a second"),
)
RECORD_HELP = (
    "record every topic, /cmd_vel and /rover/metrics too; a killed run's file is read by "
    "rover_metrics.replay as it is, and "
    "mended by: mcap recover FILE.mcap -o MENDED.mcap"
)
FILES: tuple[Option, ...] = (
    ("--record", Path, "FILE.mcap", RECORD_HELP),
    ("--report", Path, "FILE.html", "write a page about the run: map, plots, truth"),
    ("--summary", Path, "FILE.json", "write the manifest there"),
    ("--social-log", Path, "FILE.csv", "the social log of a run with people; default: see --log-dir"),
)
PICTURES: tuple[Option, ...] = (
    ("--picture", Path, "FILE.png", "draw the rover at the end of its path"),
    ("--video", Path, "FILE.mp4", "draw the run in at most 10 s, with time and speed (extra [video])"),
)
Group = argparse._ArgumentGroup  # noqa: SLF001 - what add_argument_group gives has no public name


def run_parser() -> argparse.ArgumentParser:
    """Parses everything but what comes after --ros-args."""
    parser = OneLineParser(
        prog="python -m harness.run",
        description="Drives a rover over rough terrain, publishes its sensors as ROS 2 topics and "
        "logs traversal metrics to CSV.",
        epilog="Arguments after --ros-args go to ROS, e.g. --ros-args -r scan:=front/scan.",
    )
    _add_episode(parser.add_argument_group("episode"), EpisodeConfig())
    sensors = parser.add_argument_group("sensors")
    about = f"sensor errors: {', '.join(PRESETS)}; {DEFAULT_PRESET} if not named; default: none"
    sensors.add_argument("--noise", nargs="?", const=DEFAULT_PRESET, metavar="NAME", help=about)
    _add(sensors, SENSORS, EpisodeConfig())
    about = (
        f"optional ones, NAME or NAME=PRESET: none, {', '.join(kinds())}, names in rover.yaml "
        "(docs/sensors.md); default: those of rover.yaml"
    )
    sensors.add_argument("--sensors", type=_names, metavar="NAME[,...]", help=about)
    about = f"{FORM}, in simulated seconds, e.g. imu:nan@10+2; repeatable"
    faults = parser.add_argument_group("faults", describe_faults())
    faults.add_argument("--fault", action="append", default=[], metavar="SPEC", help=about)
    _add_run(parser.add_argument_group("run"))
    _add_frames(parser.add_argument_group("frames"), FrameOptions())
    commands = parser.add_argument_group("commands of --driver cmd_vel")
    about = "type of /cmd_vel; auto: as it is sent, TwistStamped from Kilted on until something is"
    commands.add_argument("--cmd-vel", choices=CMD_VEL_TYPES, default="auto", help=about)
    _add(commands, COMMANDS)
    pictures = parser.add_argument_group("pictures")
    _add(pictures, PICTURES)
    pictures.add_argument(
        "--picture-lidar", action="store_true", help="show the lidar's hits and some of its beams"
    )
    parser.add_argument("--list", action="store_true", help="print terrains, robots and drivers")
    parser.add_argument("--version", action="version", version=f"rover-harness {__version__}")
    return parser


def _add(group: Group, options: Sequence[Option], defaults: object = None) -> None:
    for flag, kind, metavar, text in options:
        default = getattr(defaults, flag.removeprefix("--").replace("-", "_"), None)
        group.add_argument(flag, type=kind, default=default, metavar=metavar, help=text)


def _add_episode(world: Group, defaults: EpisodeConfig) -> None:
    about = (
        "see --list; a heightmap: GeoTIFF, TIFF, PNG, .npy; an SDF world: .world, .sdf; a mesh: .dae, "
        ".obj, .stl (docs/worlds.md: axes, units)"
    )
    world.add_argument("--terrain", default=defaults.terrain, metavar="NAME|FILE", help=about)
    about = "length along x and y, or of both, of a heightmap that does not say"
    world.add_argument("--terrain-size", type=float, nargs="+", metavar="M", help=about)
    about = "relief, lowest to highest point, of a heightmap that does not say"
    world.add_argument("--terrain-height", type=float, metavar="M", help=about)
    world.add_argument("--actor", action="append", default=[], metavar="SPEC", help=ACTOR_HELP)
    for flag, kind, metavar, text in WORLDS:
        is_many = flag in REPEATABLE
        world.add_argument(
            flag,
            type=kind,
            metavar=metavar,
            help=text,
            action="append" if is_many else "store",
            default=[] if is_many else getattr(defaults, flag[2:].replace("-", "_")),
        )
    about = (
        f"several in one world, {ROVER_FORM}, each in its NAME's namespace; KEYs: {', '.join(KEYS)}; "
        "all other options hold for all of them (docs/fleets.md)"
    )
    world.add_argument("--rover", action="append", default=[], metavar="SPEC", help=about)
    about = "start [m] and heading from +x to +y [rad]; default: at or next to 0,0, the middle"
    world.add_argument("--start", type=_start, metavar="X,Y[,YAW]", help=about)
    about = f"where the world's origin is, for GNSS and its like; default: {_told(defaults.datum)}"
    world.add_argument(
        "--datum", type=_datum, default=defaults.datum, metavar="LAT,LON[,ALT]", help=about
    )
    about = "give the driver one random goal after another in this rectangle, as RoboTerrain's collector"
    world.add_argument("--goal-area", type=_area, metavar="XMIN,XMAX,YMIN,YMAX", help=about)
    _add(world, EPISODE, defaults)


def _add_run(run: Group) -> None:
    run.add_argument("--rate", type=_rate, metavar="R|max", help="times real time; default: max")
    about = "folder for the log and its manifest; with --actor, for social/social_log_....csv too"
    run.add_argument("--log-dir", type=Path, default=DEFAULT_LOG_DIR, metavar="DIR", help=about)
    run.add_argument(
        "--namespace", default="", metavar="NAME", help="of all topics but /clock, e.g. rover1"
    )
    run.add_argument("--no-metrics", action="store_true", help="publish only; host no metrics_node")
    run.add_argument("--direct", action="store_true", help="no ROS: samples go straight to the CSV")
    about = "log the extended columns too (docs/metrics.md), with the rover's footprint"
    run.add_argument("--extended", action="store_true", help=about)
    about = "ROS parameter file (YAML) of metrics_node, with ROS or without: thresholds, columns"
    run.add_argument("--params", type=Path, metavar="FILE", help=about)
    about = "keep lock-step with a node in another process; repeatable"
    run.add_argument("--wait-for", action="append", default=[], metavar="NODE", help=about)
    _add(run, FILES)
    run.add_argument("--overwrite", action="store_true", help="let --record replace a file")


def _names(text: str) -> tuple[str, ...]:
    return tuple(word.strip() for word in text.split(","))


def _start(text: str) -> Start:
    words = text.split(",")
    try:
        x, y, yaw = map(float, words if len(words) == 3 else [*words, "0"])
    except ValueError:
        message = f"'{text}' is not valid; give X,Y or X,Y,YAW in metres and radians"
        raise argparse.ArgumentTypeError(message) from None
    return x, y, yaw


def _datum(text: str) -> tuple[float, float, float]:
    words = text.split(",")
    try:
        latitude, longitude, altitude = map(float, words if len(words) == 3 else [*words, "0"])
    except ValueError:
        message = f"'{text}' is not valid; give LAT,LON or LAT,LON,ALT in degrees and metres"
        raise argparse.ArgumentTypeError(message) from None
    return latitude, longitude, altitude


def _told(numbers: tuple[float, ...]) -> str:
    return ",".join(f"{number:.10g}" for number in numbers)


def _area(text: str) -> Area:
    try:
        x_min, x_max, y_min, y_max = map(float, text.split(","))
    except ValueError:
        message = f"'{text}' is not valid; give XMIN,XMAX,YMIN,YMAX in metres"
        raise argparse.ArgumentTypeError(message) from None
    return x_min, x_max, y_min, y_max


def _add_frames(frames: Group, defaults: FrameOptions) -> None:
    about = "who owns odom -> base on /tf; none where an EKF does"
    frames.add_argument("--odom-tf", choices=ODOM_SOURCES, default=defaults.odom_tf, help=about)
    about = "with the true height, roll and pitch; else the pose from above"
    frames.add_argument("--odom-tf-3d", action="store_true", help=about)
    frames.add_argument("--map-tf", action="store_true", help="tell map -> odom too, as the identity")


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
