"""Messages of ROS as rosbags knows them, without ROS: their definitions, and the numbers in them.

A path leads to numbers in a message: names of fields with dots between them, each followed by [INDEX]
where it is a list and one element is meant; without, all are.
"""

import re
from functools import cache
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.serde import SerdeError
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from harness.base.errors import unknown

STEP = re.compile(r"(?P<name>[A-Za-z]\w*)(?:\[(?P<index>\d+)\])?")
GRID_MAP = "grid_map_msgs/msg/GridMap"
# What rosbags does not know: grid_map_msgs of ROS 2, without its comments.
DEFINITIONS = {
    "grid_map_msgs/msg/GridMapInfo": """
float64 resolution
float64 length_x
float64 length_y
geometry_msgs/Pose pose
""",
    GRID_MAP: """
std_msgs/Header header
grid_map_msgs/GridMapInfo info
string[] layers
string[] basic_layers
std_msgs/Float32MultiArray[] data
uint16 outer_start_index
uint16 inner_start_index
""",
}
MOST = 12  # fields that a message lists where one does not exist


@cache  # it takes a while to build
def typestore() -> Typestore:
    """Returns all message types that rosbags knows, and DEFINITIONS."""
    store = get_typestore(Stores.LATEST)
    for name, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, name))
    return store


def made(name: str, *values: Any) -> Any:  # noqa: ANN401 - rosbags makes its classes
    """Returns a message of a type, of the values of its fields."""
    return typestore().types[name](*values)


def read_message(data: bytes, name: str) -> Any:  # noqa: ANN401 - rosbags makes its classes
    """Returns the message of that type that these bytes are; ValueError if they are none."""
    try:
        return typestore().deserialize_cdr(data, name)
    except SerdeError as error:
        raise ValueError(str(error)) from error


def check_path(type_name: str, path: str) -> str | None:
    """Returns what is wrong with a path into messages of a type; None if it leads to numbers.

    Args:
        type_name: As in sensor_msgs/msg/LaserScan. Where rosbags does not know it, only the form counts.
        path: As in twist.twist.linear.x, ranges or poses[0].position.x.
    """
    node: Any = (Nodetype.NAME, type_name)
    for step in path.split("."):
        match = STEP.fullmatch(step)
        if match is None:
            return f"'{path}' is no path to a field; give e.g. twist.linear.x or ranges[0]"
        if node[0] == Nodetype.NAME and node[1] not in typestore().fielddefs:
            continue
        if node[0] != Nodetype.NAME:
            return f"there is nothing below the numbers in front of '.{step}' in '{path}'"
        fields = dict(typestore().fielddefs[node[1]][1])
        if match["name"] not in fields:
            return f"{unknown('field', match['name'], list(fields)[:MOST])} ({node[1]})"
        node = fields[match["name"]]
        if node[0] in (Nodetype.ARRAY, Nodetype.SEQUENCE):
            node = node[1][0]
        elif match["index"] is not None:
            return f"field '{match['name']}' is no list; leave out [{match['index']}] ({type_name})"
    return _no_number(node)


def _no_number(node: Any) -> str | None:  # noqa: ANN401 - of rosbags
    if node[0] == Nodetype.BASE:
        return "it leads to text; give a field with numbers" if node[1][0] == "string" else None
    if node[1] not in typestore().fielddefs:
        return None
    names = ", ".join(name for name, _ in typestore().fielddefs[node[1]][1])
    return f"it leads to a {node[1]}; go on with one of: {names}"


def numbers_at(message: Any, path: str) -> list[float]:  # noqa: ANN401 - of rclpy or of rosbags
    """Returns the numbers at a path of a message, truth values as 0 and 1; an index too high gives none.

    Raises:
        AttributeError: A field does not exist.
        ValueError: It is no number.
    """
    parts = [message]
    for step in path.split("."):
        name, _, index = step.rstrip("]").partition("[")
        lists = (_listed(getattr(part, name)) for part in parts)
        chosen = (some[int(index) : int(index) + 1] if index else some for some in lists)
        parts = [part for some in chosen for part in some]
    return [float(one[0] if isinstance(one, bytes) else one) for one in parts]  # a byte as of rclpy


def _listed(value: Any) -> Any:  # noqa: ANN401 - a list, an array, or one value
    return value if hasattr(value, "__len__") and not isinstance(value, str | bytes) else [value]
