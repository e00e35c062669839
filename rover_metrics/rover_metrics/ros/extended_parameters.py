"""The ROS parameters of the extended columns."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, LidarPose
from rover_metrics.extended.settings import (
    DEFAULT_EXTENDED,
    LARGEST,
    ExtendedSettings,
)

SWITCH = "extended_columns"
NAMES = ("footprint", "lidar_pose", "near_returns_as_contact", "footprint_threshold", "gravity")


def descriptors() -> dict[str, tuple[Any, ParameterDescriptor]]:
    """Give default and descriptor by name; an empty list of doubles is given by its type."""
    return {
        SWITCH: (False, _switch()),
        "footprint": (Parameter.Type.DOUBLE_ARRAY, _footprint()),
        "lidar_pose": ([0.0, 0.0, 0.0], _lidar_pose()),
        "near_returns_as_contact": (DEFAULT_EXTENDED.near_returns_as_contact, _near_returns()),
        "footprint_threshold": (DEFAULT_EXTENDED.footprint_threshold, _footprint_threshold()),
        "gravity": (DEFAULT_EXTENDED.gravity, _gravity()),
    }


def fill_empty(node: Node) -> None:
    """Give an empty list to parameters that were declared by type and not set by the launch.

    Unset ones make every request for all parameters fail (ros2 param dump).
    """
    for name, (default, _) in descriptors().items():
        if isinstance(default, Parameter.Type) and node.get_parameter_or(name).value is None:
            node.set_parameters([Parameter(name, default, [])])


def refuse_switching(now: bool, wish: bool) -> None:
    """Refuse to change which columns a log has.

    Raises:
        ParameterError: The wish differs.
    """
    if wish != now:
        message = (
            f"{SWITCH} is fixed once the node runs, for the header of this log is written; start "
            f"the node with -p {SWITCH}:={str(wish).lower()}"
        )
        raise ParameterError(message)


def updated(settings: ExtendedSettings, values: Mapping[str, Any]) -> ExtendedSettings:
    """Give these settings with some parameters changed; names of others are ignored.

    Raises:
        ParameterError: A value is not valid.
    """
    changes: dict[str, Any] = {name: values[name] for name in NAMES if name in values}
    if "footprint" in changes:
        flat = changes["footprint"] or ()
        changes["footprint"] = Footprint.from_flat(flat) if len(flat) else None
    if "lidar_pose" in changes:
        changes["lidar_pose"] = LidarPose.from_flat(changes["lidar_pose"])
    return replace(settings, **changes)


def _switch() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="write the extended columns of docs/metrics.md after the twelve; fixed once the "
        "node runs, for the header of a log cannot change",
        additional_constraints="true or false, not 0 or 1",
    )


def _footprint() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="corners of the rover's outline in the base frame, in order: x0, y0, x1, y1, ... "
        "[m]; empty leaves the columns of the footprint empty",
        additional_constraints="a list of numbers with decimal points, 3 corners or more of a polygon "
        "that does not cross itself, e.g. [0.2, 0.2, -0.2, 0.2, -0.2, -0.2, 0.2, -0.2]",
    )


def _lidar_pose() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="x, y, yaw of the lidar's frame in the base frame [m, m, rad]",
        additional_constraints="a list of three numbers with decimal points, e.g. [0.174, 0.0, 3.14159]",
    )


def _near_returns() -> ParameterDescriptor:
    return ParameterDescriptor(
        description="a return nearer than range_min (-inf, REP-117) is footprint clearance 0",
        additional_constraints="true or false, not 0 or 1",
    )


def _footprint_threshold() -> ParameterDescriptor:
    meaning = "a scan whose footprint clearance is below this is a footprint collision [m]"
    return _number("footprint_threshold", meaning)


def _gravity() -> ParameterDescriptor:
    return _number("gravity", "what the IMU reads at rest, taken out of Roughness RMS [m/s^2]")


def _number(name: str, meaning: str) -> ParameterDescriptor:
    largest, unit = LARGEST[name]
    valid = f"a number with a decimal point (0.1, not 1) from 0.0 to {largest} {unit}"
    return ParameterDescriptor(
        description=meaning,
        additional_constraints=valid,
        floating_point_range=[FloatingPointRange(from_value=0.0, to_value=largest, step=0.0)],
    )
