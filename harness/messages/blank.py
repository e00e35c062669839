"""Messages to be filled in: objects of rosbags, with the defaults that rclpy gives their fields."""

from difflib import get_close_matches
from functools import cache
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype

from harness.base.errors import UsageError
from harness.base.message_types import typestore

Message = Any  # rosbags makes its classes
DEFAULTS: dict[str, dict[str, float]] = {  # those that are not zero
    "geometry_msgs/msg/Quaternion": {"w": 1.0},
    "sensor_msgs/msg/NavSatStatus": {"status": -2, "service": 0},
}
WORD = 4  # [B]
PLAIN = {"bool": False, "string": ""}


def blank(name: str) -> Message:
    """Returns a message of a type such as sensor_msgs/msg/Imu: zeros, empty texts and lists, no turn."""
    known = typestore().fielddefs
    if name not in known:
        near = (get_close_matches(name, known, 1, 0.5) or ["std_msgs/msg/Float64"])[0]
        raise UsageError(f"there is no message type '{name}'; give one such as {near}")
    fields = known[name][1]
    own = DEFAULTS.get(name, {})
    return typestore().types[name](*(own.get(field, _default(node)) for field, node in fields))


def kind_of(message: Message) -> str:
    """Returns the name of a message's type, as in sensor_msgs/msg/LaserScan."""
    name: str = message.__msgtype__
    return name


def cdr(message: Message) -> bytes:
    """Returns the bytes of a message; of a type of fixed size whole words, as Fast DDS has them."""
    kind = kind_of(message)
    data = bytes(typestore().serialize_cdr(message, kind))
    return data + bytes(-len(data) % WORD) if _is_fixed(kind) else data


@cache
def _is_fixed(kind: str) -> bool:
    """Whether there is no text and no list of any length in messages of a type."""
    nodes = (_innermost(node) for _, node in typestore().fielddefs[kind][1])
    return all(
        _is_fixed(name)
        if category == Nodetype.NAME
        else category == Nodetype.BASE and name[0] != "string"
        for category, name in nodes
    )


def _innermost(node: Any) -> Any:  # noqa: ANN401 - of rosbags
    """What an array of fixed length is of, or the node itself."""
    return node[1][0] if node[0] == Nodetype.ARRAY else node


def _default(node: Any) -> Any:  # noqa: ANN401 - of rosbags
    category, detail = node
    if category == Nodetype.NAME:
        return blank(detail)
    if category == Nodetype.BASE:
        return PLAIN.get(detail[0], 0.0 if detail[0].startswith("float") else 0)
    (inner, kind), length = detail
    if inner != Nodetype.BASE or kind[0] == "string":
        count = length if category == Nodetype.ARRAY else 0
        return [_default((inner, kind)) for _ in range(count)]
    dtype = {"byte": "uint8", "char": "uint8", "octet": "uint8"}.get(kind[0], kind[0])
    return np.zeros(length if category == Nodetype.ARRAY else 0, dtype)
