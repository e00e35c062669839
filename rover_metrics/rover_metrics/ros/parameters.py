"""Declares the parameters of rover_metrics.extended.settings to ROS, and says what is valid."""

from collections.abc import Iterable
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException
from rclpy.node import Node
from rclpy.parameter import Parameter

from rover_metrics.core.parameter import ParameterInfo
from rover_metrics.errors import ParameterError
from rover_metrics.extended.settings import PARAMETERS, Settings, check_name

RELIABLE, BEST_EFFORT = "reliable", "best_effort"


def declare_settings(node: Node, settings: Settings) -> Settings:
    """Declares all parameters; returns what the launch has made of them, or raises a ParameterError."""
    defaults = settings.parameters
    values = {name: _declare(node, name, info, defaults[name]) for name, info in PARAMETERS.items()}
    for name, value in values.items():
        # One that is not set would make every request for all parameters fail (ros2 param dump).
        if value is None:
            node.set_parameters([Parameter(name, Parameter.Type.DOUBLE_ARRAY, [])])
    return settings.updated(values)


def declare_reliability(node: Node, topic: str, default: str) -> tuple[str, str]:
    """Declares the standard ROS parameter for the reliability of a subscription; returns name and value.

    Args:
        node: The subscribing node.
        topic: The topic's resolved name.
        default: RELIABLE or BEST_EFFORT; of any other value in the launch a ParameterError tells.
    """
    name = f"qos_overrides.{topic}.subscription.reliability"
    info = ParameterInfo(
        default=default,
        description=f"reliability that this node asks of publishers on {topic}",
        valid=f"{RELIABLE} or {BEST_EFFORT}, as text",
        read_only=True,
    )
    value = str(_declare(node, name, info, default))
    if value not in (RELIABLE, BEST_EFFORT):
        raise ParameterError(_must_be(name, info.constraint))
    return name, value


def wrong_name_or_type(node: Node, parameters: Iterable[Parameter]) -> str | None:
    """Returns what is valid for the first parameter of a wrong name or type; None if all fit.

    rclpy rejects these too, but names the types by number: "expected '3' got '2'", and names never.
    """
    for parameter in parameters:
        name = parameter.name
        if not node.has_parameter(name):
            return _unknown(name)
        declared = node.describe_parameter(name)
        if declared.additional_constraints and declared.type != parameter.type_.value:
            return _must_be(name, declared.additional_constraints)
    return None


def require_same_columns(now: Settings, wish: Settings) -> None:
    """Raises a ParameterError if a wish would change which columns the log has."""
    if wish.extended_columns != now.extended_columns:
        raise ParameterError(
            "extended_columns is fixed once the node runs, for the header of this log is written; start "
            f"the node with -p extended_columns:={str(wish.extended_columns).lower()}"
        )


def _declare(node: Node, name: str, info: ParameterInfo, default: object) -> Any:  # noqa: ANN401
    if default == []:
        default = Parameter.Type.DOUBLE_ARRAY  # an empty list has no type of its own
    try:
        value = node.declare_parameter(name, default, _descriptor(info)).value
    except ParameterException as error:
        raise ParameterError(_must_be(name, info.constraint)) from error
    if value is None and default is not Parameter.Type.DOUBLE_ARRAY:  # an empty list of a launch
        raise ParameterError(_must_be(name, info.constraint))
    return value


def _descriptor(info: ParameterInfo) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(
        description=f"{info.description} [{info.unit}]" if info.unit else info.description,
        additional_constraints=info.constraint,
        read_only=info.read_only,
    )
    if isinstance(info.default, float):
        valid = FloatingPointRange(from_value=info.minimum, to_value=info.maximum, step=0.0)
        descriptor.floating_point_range = [valid]
    elif type(info.default) is int:
        whole = IntegerRange(from_value=int(info.minimum), to_value=int(info.maximum), step=1)
        descriptor.integer_range = [whole]
    return descriptor


def _unknown(name: str) -> str:
    try:
        check_name(name, may_be_others=False)
    except ParameterError as error:
        return str(error)
    return f"there is no parameter {name}"


def _must_be(name: str, constraint: str) -> str:
    return f"parameter {name} must be {constraint}"
