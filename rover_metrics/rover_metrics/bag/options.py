"""What the user tells rover_metrics.replay: a command line and a ROS parameter file, without ROS.

Every mistake is told in one line.
"""

import argparse
import difflib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from rover_metrics.core.thresholds import THRESHOLD_INFO
from rover_metrics.errors import OneLineParser, ParameterError
from rover_metrics.extended.settings import EXTENDED_INFO, PARAMETERS, Settings
from rover_metrics.timing.recorded_time import TimeSource
from rover_metrics.topics import CLOCK, SENSORS, TRUTH

DEFAULT_LOG_DIR = Path(Settings().log_dir)
NODE_NAMES = ("metrics_node", "*", "**")
_OF_THE_ROWS = (*THRESHOLD_INFO, "extended_columns", *EXTENDED_INFO)
_TYPES = {
    bool: "true or false, not 0 or 1",
    float: "a number with a decimal point (1.0, not 1)",
    tuple: "a list of numbers with decimal points",
}


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


def read_parameters(path: Path) -> Settings:
    """Returns the settings of a file as for `--ros-args --params-file`.

    Later sections of the node win; parameters that do not matter to the rows keep their defaults.

    Raises:
        ParameterError: The file is not readable, names no parameters for metrics_node, or a value
            is not valid.
    """
    try:
        document = YAML(typ="safe").load(path)
    except (OSError, UnicodeDecodeError, YAMLError) as error:
        reason = error.strerror if isinstance(error, OSError) else " ".join(str(error).split())
        raise ParameterError(f"cannot read parameters from {path}: {reason}") from error
    sections = list(_sections(document, ""))
    if not sections:
        raise ParameterError(f"{path} has no section 'metrics_node: ros__parameters:'")
    values = {
        str(name): value
        for section in sections
        for name, value in section.items()
        if _matters(str(name), value)
    }
    try:
        return Settings().updated(values)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error


def _sections(node: Any, name: str) -> Iterator[Mapping[Any, Any]]:  # noqa: ANN401 - any YAML
    """The parameters of each section that is about metrics_node, in any namespace."""
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key != "ros__parameters":
            yield from _sections(value, str(key).rpartition("/")[2])
        elif name in NODE_NAMES and isinstance(value, dict):
            yield value


def _matters(name: str, value: object) -> bool:
    """Whether a parameter has a say in the rows; checks that its type is what ROS asks for."""
    if name not in _OF_THE_ROWS:
        meant = difflib.get_close_matches(name, _OF_THE_ROWS, n=1, cutoff=0.8)
        if meant:
            raise ParameterError(f"there is no parameter {name}; did you mean {meant[0]}?")
        return False
    info = PARAMETERS[name]
    if isinstance(info.default, tuple):
        fits = isinstance(value, list) and all(isinstance(number, float) for number in value)
    else:
        fits = isinstance(value, type(info.default))
    if not fits:
        valid = info.constraint if name in THRESHOLD_INFO else _TYPES[type(info.default)]
        raise ParameterError(f"parameter {name} must be {valid}")
    return True
