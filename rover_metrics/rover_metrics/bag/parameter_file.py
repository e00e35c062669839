"""Reads the parameters of metrics_node from a ROS parameter file, without ROS."""

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from rover_metrics.core.thresholds import DEFAULT_THRESHOLDS, THRESHOLD_INFO, Thresholds
from rover_metrics.errors import ParameterError, ThresholdError
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.settings import DEFAULT_EXTENDED, ExtendedSettings

NODE_NAMES = ("metrics_node", "*", "**")
_SWITCHES = ("extended_columns", "near_returns_as_contact")
_LISTS = ("footprint", "lidar_pose")
_NUMBERS = (*THRESHOLD_INFO, "footprint_threshold", "gravity")
_KNOWN = (*_NUMBERS, *_LISTS, *_SWITCHES)


@dataclass(frozen=True)
class FileParameters:
    """What of a parameter file matters to the rows.

    Attributes:
        thresholds: Of all rows.
        extended_columns: Whether rows have the extended columns.
        extended: What only those need.
    """

    thresholds: Thresholds = DEFAULT_THRESHOLDS
    extended_columns: bool = False
    extended: ExtendedSettings = DEFAULT_EXTENDED


def read_parameters(path: Path) -> FileParameters:
    """Read a file as for `--ros-args --params-file`.

    Later sections of the node win; parameters that do not matter to the rows are left alone.

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
    values: dict[str, Any] = {}
    for section in sections:
        for name, value in section.items():
            values |= _checked(str(name), value)
    try:
        return _parameters(values)
    except (ThresholdError, ParameterError) as error:
        raise ParameterError(f"{path}: {error}") from error


def _parameters(values: dict[str, Any]) -> FileParameters:
    is_extended = values.pop("extended_columns", False)
    thresholds = {name: values.pop(name) for name in THRESHOLD_INFO if name in values}
    if "footprint" in values:
        values["footprint"] = Footprint.from_flat(values["footprint"]) if values["footprint"] else None
    if "lidar_pose" in values:
        values["lidar_pose"] = LidarPose.from_flat(values["lidar_pose"])
    return FileParameters(Thresholds(**thresholds), is_extended, ExtendedSettings(**values))


def _sections(node: Any, name: str) -> Iterator[Mapping[Any, Any]]:  # noqa: ANN401 - any YAML
    """The parameters of each section that is about metrics_node, in any namespace."""
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key != "ros__parameters":
            yield from _sections(value, str(key).rpartition("/")[2])
        elif name in NODE_NAMES and isinstance(value, dict):
            yield value


def _checked(name: str, value: object) -> dict[str, Any]:
    """The parameter if it matters, checked for its type as ROS would."""
    if name not in _KNOWN:
        meant = difflib.get_close_matches(name, _KNOWN, n=1, cutoff=0.8)
        if meant:
            raise ParameterError(f"there is no parameter {name}; did you mean {meant[0]}?")
        return {}
    if name in _SWITCHES and not isinstance(value, bool):
        raise ParameterError(f"parameter {name} must be true or false, not 0 or 1")
    if name in _LISTS and not (isinstance(value, list) and all(isinstance(v, float) for v in value)):
        raise ParameterError(f"parameter {name} must be a list of numbers with decimal points")
    if name in _NUMBERS and not isinstance(value, float):
        info = THRESHOLD_INFO.get(name)
        valid = "" if info is None else f" {info.valid_range}"
        raise ParameterError(
            f"parameter {name} must be a number with a decimal point (1.0, not 1){valid}"
        )
    return {name: value}
