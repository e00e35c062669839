"""The parameters of metrics_node in a ROS parameter file (YAML), read without ROS."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from rover_metrics.errors import ParameterError
from rover_metrics.extended.settings import PARAMETERS, Settings, check_name
from rover_metrics.log.documents import DocumentError, read_yaml

NODE_NAME = "metrics_node"
EVERY_NODE = ("*", "**")


def read_values(path: Path) -> dict[str, Any]:
    """Returns the parameters that a file sets, by name, all valid; else raises a ParameterError.

    Later sections of the node win. An empty list sets nothing.
    """
    try:
        document = read_yaml(path)
    except DocumentError as error:
        raise ParameterError(f"cannot read parameters from {path}: {error}") from error
    sections = list(_sections(document, ""))
    if not sections:
        raise ParameterError(f"{path} has no section 'metrics_node: ros__parameters:'")
    try:
        values = {
            str(name): value
            for is_own, section in sections
            for name, value in section.items()
            if _is_parameter(str(name), value, is_own=is_own) and value != []
        }
        Settings().updated(values)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    return values


def _sections(node: Any, name: str) -> Iterator[tuple[bool, Mapping[Any, Any]]]:  # noqa: ANN401 - any YAML
    """The parameters of each section for metrics_node, in any namespace, and whether for it alone."""
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key != "ros__parameters":
            yield from _sections(value, str(key).rpartition("/")[2])
        elif name in (NODE_NAME, *EVERY_NODE) and isinstance(value, dict):
            yield name == NODE_NAME, value


def _is_parameter(name: str, value: object, *, is_own: bool) -> bool:
    """Whether a name is a parameter of the node's own; checks that its type is what ROS asks for."""
    if not check_name(name, may_be_others=not is_own):
        return False
    info = PARAMETERS[name]
    if isinstance(info.default, tuple):
        fits = isinstance(value, list) and all(isinstance(number, float) for number in value)
    else:
        fits = type(value) is type(info.default)
    if not fits:
        raise ParameterError(f"parameter {name} must be {info.constraint}")
    return True
