"""The command line of rover_metrics.replay."""

import argparse
from pathlib import Path

from rover_metrics.errors import OneLineParser
from rover_metrics.extended.settings import Settings
from rover_metrics.timing.recorded_time import TimeSource
from rover_metrics.topics import CLOCK, SENSORS, TRUTH

DEFAULT_LOG_DIR = Path(Settings().log_dir)


def parser() -> argparse.ArgumentParser:
    """Returns the parser."""
    parser = OneLineParser(
        prog="python -m rover_metrics.replay",
        description="Computes the traversal metrics of a recorded drive, as metrics_node would have.",
        epilog="A row holds everything up to and including its full second. Recordings that were "
        "killed, cut off or damaged are read as far as they go; the exit code is then 1. A topic that a "
        "whole recording lacks is a warning.",
    )
    parser.add_argument("bag", type=Path, metavar="BAG", help="rosbag2 folder, .mcap or .db3 file")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="CSV",
        help=f"file, or folder for a metrics_log_*.csv; default: {DEFAULT_LOG_DIR}/",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace the file of -o")
    parser.add_argument(
        "--require-all",
        action="store_true",
        help="exit with 1 too if a topic is missing or a message was left out",
    )
    parser.add_argument("--params", type=Path, metavar="FILE", help="ROS parameter file (YAML)")
    parser.add_argument(
        "--extended",
        action="store_true",
        help="write the extended columns too (docs/metrics.md); so does extended_columns in --params, "
        "which may also name footprint and lidar_pose",
    )
    parser.add_argument(
        "--remap",
        type=_remap,
        action="append",
        default=[],
        metavar="FROM:=TO",
        help="read topic FROM from the recorded topic TO, e.g. scan:=front/scan; repeatable",
    )
    parser.add_argument(
        "--time",
        choices=[source.value for source in TimeSource],
        default=TimeSource.AUTO.value,
        help="what rows follow: /clock (sim), when messages were recorded, their header stamps; "
        "auto is sim where the recording has /clock, else recorded",
    )
    return parser


def _remap(text: str) -> tuple[str, str]:
    """Returns the two parts of FROM:=TO, both made absolute."""
    known = [source.name for source in (*SENSORS, *TRUTH, CLOCK)]
    name, separator, recorded = text.partition(":=")
    name, recorded = (f"/{part.strip().lstrip('/')}" for part in (name, recorded))
    if not separator or recorded == "/" or name not in known:
        valid = ", ".join(topic.lstrip("/") for topic in known)
        message = f"'{text}' is not valid; give FROM:=TO, where FROM is one of {valid}"
        raise argparse.ArgumentTypeError(message)
    return name, recorded
