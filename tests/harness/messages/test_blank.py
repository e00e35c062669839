"""Messages made without ROS are those that rclpy makes: defaults, bytes and lengths."""

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2: pip install -e '.[ros]'")

from rclpy.serialization import deserialize_message, serialize_message

from harness.base.message_types import GRID_MAP
from harness.episode.diagnostics import METRICS
from harness.episode.maps import MAP
from harness.messages.blank import blank, cdr
from harness.messages.cdr import without_padding
from harness.messages.outlets import CLOCK, GOAL, PERSON
from harness.messages.transforms import DESCRIPTION, TF_MESSAGE
from harness.ros.foreign_type import message_type
from harness.sensors.table import SENSORS

TOLD = {topic.message_type for topic in (METRICS, MAP, CLOCK, GOAL, DESCRIPTION)} | {PERSON}
SENSED = {topic.message_type for row in SENSORS for topic in row.topics} - {TF_MESSAGE, GRID_MAP}


@pytest.mark.parametrize("kind", sorted(TOLD | SENSED))
def test_a_blank_message_is_rclpys_and_has_its_bytes(kind: str) -> None:
    """But for what Fast DDS appends where lists are empty."""
    made = message_type(kind)
    assert made is not None
    own, theirs = cdr(blank(kind)), without_padding(serialize_message(made()), kind)
    assert theirs[: len(own)] == own
    assert not any(theirs[len(own) :])
    assert deserialize_message(own, made) == made()
