"""Numbers put into a message's bytes are where another implementation of CDR, rosbags', reads them."""

from itertools import count
from typing import Any

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.serialization import serialize_message

from harness.base.message_types import GRID_MAP, numbers_at, read_message
from harness.messages.cdr import Template, places
from harness.messages.transforms import TF_MESSAGE
from harness.ros.foreign_type import message_type
from harness.sensors.table import SENSORS

KINDS = sorted({topic.message_type for row in SENSORS for topic in row.topics} - {TF_MESSAGE, GRID_MAP})


def lengthened(message: Any, text: str, size: int) -> Any:  # noqa: ANN401 - of rclpy
    """A message with texts and lists of numbers of a length."""
    for name, kind in message.get_fields_and_field_types().items():
        value = getattr(message, name)
        if kind == "string":
            setattr(message, name, text)
        elif kind == "sequence<string>":
            setattr(message, name, [text, ""])
        elif hasattr(value, "get_fields_and_field_types"):
            lengthened(value, text, size)
        elif hasattr(value, "typecode"):
            value.frombytes(bytes(size * value.itemsize))
    return message


@pytest.mark.parametrize(("text", "size"), [("", 0), ("abc", 1), ("odd!", 3), ("long enough", 40)])
@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_a_topics_messages_is_put_where_it_is_read(
    kind: str, text: str, size: int
) -> None:
    made = message_type(kind)
    assert made is not None
    message = lengthened(made(), text, size)
    data, found = serialize_message(message), places(message, kind)
    leaves = {
        path: place for path, place in found.items() if len(place.letter) == 1 and place.length != 0
    }
    values, following = {}, count(1)
    for path, place in leaves.items():
        values[path] = [
            next(following) % (2 if place.letter == "?" else 100) for _ in range(place.length or 1)
        ]
    template = Template(data, list(leaves.values()))
    assert template.fits(list(values.values()))
    told = read_message(template.filled(list(values.values()))[: found[""].start], kind)
    assert {path: numbers_at(told, path) for path in leaves} == values
    assert len(data) - 16 < found[""].start <= len(data)
