"""The parameters of metrics_node in a ROS parameter file (YAML), read without ROS."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from rover_metrics.errors import ParameterError
from rover_metrics.extended.settings import PARAMETERS, Settings, check_name
from rover_metrics.log.documents import DocumentError, read_yaml

NODE_NAME = "metrics_node"
WILDCARDS = {"*": r"/\w+", "**": r"(?:/\w+)*"}  # as rcl has them


def read_values(path: Path, namespace: str | None = "", fleet: Sequence[str] = ()) -> dict[str, Any]:
    """Returns the parameters that a file sets, by name, all valid; else raises a ParameterError.

    Those sections count that ROS would give the node; later ones win. An empty list sets nothing.

    Args:
        path: The file.
        namespace: The node's, without slashes around it; "" for the root, None for wherever the only
            metrics_node of the file is.
        fleet: Namespaces of all nodes that the file may be for; one of them must have a section.
    """
    try:
        document = read_yaml(path)
    except DocumentError as error:
        raise ParameterError(f"cannot read parameters from {path}: {error}") from error
    sections = list(_sections(document, ""))
    there = dict.fromkeys(name for name, _ in sections if name.endswith(f"/{NODE_NAME}"))
    node = _node(namespace)
    if namespace is None and len(there) == 1:
        (node,) = there
    own = [(name, section) for name, section in sections if _is_of(name, node)]
    nodes = [node, *map(_node, fleet)]
    if not any(_is_of(name, one) for one in nodes for name, _ in sections):
        others = ", ".join(there)
        hint = f"; it has {others}; '/**' holds in every namespace" if others else ""
        raise ParameterError(f"{path} has no section '{node}: ros__parameters:'{hint}")
    try:
        values = {
            str(name): value
            for section_name, section in own
            for name, value in section.items()
            if _is_parameter(str(name), value, is_own=section_name.endswith(NODE_NAME)) and value != []
        }
        Settings().updated(values)
    except ParameterError as error:
        raise ParameterError(f"{path}: {error}") from error
    return values


def _node(namespace: str | None) -> str:
    """The full name of a node in a namespace."""
    return f"/{namespace}/{NODE_NAME}" if namespace else f"/{NODE_NAME}"


def _sections(node: Any, name: str) -> Iterator[tuple[str, Mapping[Any, Any]]]:  # noqa: ANN401 - any YAML
    """The parameters of each section, by the full names of nodes that it is for."""
    if not isinstance(node, dict):
        return
    for key, value in node.items():
        if key != "ros__parameters":
            yield from _sections(value, f"{name}/{str(key).strip('/')}")
        elif isinstance(value, dict):
            yield name, value


def _is_of(section: str, node: str) -> bool:
    """Whether a section's name, with `*` for one name and `**` for any number, is that of a node."""
    parts = (WILDCARDS.get(part, f"/{re.escape(part)}") for part in section.split("/")[1:])
    return re.fullmatch("".join(parts), node) is not None


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
