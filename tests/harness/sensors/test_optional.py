"""Names, topics and mounts of optional sensors."""

from dataclasses import replace

import pytest

from harness.base.errors import UsageError
from harness.robots import FrameRow
from harness.sensors.optional import SensorOptions
from tests.support.rovers import LEO

BARE = LEO.but(frames=(), rest_height=0.2)


@pytest.mark.parametrize(
    ("name", "topic", "wrong"),
    [
        ("eye", "", None),
        ("Z9", "front/points", None),
        ("front_2", "a/b_1/C", None),
        ("", "", "name ''"),
        ("2", "", "name '2'"),
        ("_a", "", "name '_a'"),
        ("a b", "", "name 'a b'"),
        ("a/b", "", "name 'a/b'"),
        ("eye", "/a", "topic '/a'"),
        ("eye", "a/", "topic 'a/'"),
        ("eye", "a//b", "topic 'a//b'"),
        ("eye", "a/2", "topic 'a/2'"),
        ("eye", "a-b", "topic 'a-b'"),
    ],
)
def test_names_and_topics_are_words_of_ros(name: str, topic: str, wrong: str | None) -> None:
    options = SensorOptions(name=name, topic=topic)
    if wrong is None:
        return options.check()
    with pytest.raises(UsageError, match=f"^{wrong} is not valid; give "):
        return options.check()


@pytest.mark.parametrize(
    ("topic", "alone", "expected"),
    [("", False, "eye/image"), ("", True, "eye/image"), ("l", False, "l/image"), ("l", True, "l")],
)
def test_a_topic_stands_before_the_sensors_own_or_for_it(topic: str, alone: bool, expected: str) -> None:
    assert SensorOptions(name="eye", topic=topic).topic_name("image", alone=alone) == expected


@pytest.mark.parametrize("frame", ["lidar_link", LEO.imu_frame, "mast"])
def test_a_frame_that_the_rover_has_is_not_made_again_unless_a_parent_is_told(frame: str) -> None:
    rover = replace(BARE, frames=(FrameRow(parent="base_footprint", child="mast"),))
    assert SensorOptions(name="eye", frame=frame).frames(rover) == ()
    (row,) = SensorOptions(name="eye", frame=frame, parent="mast").frames(rover)
    assert (row.parent, row.child) == ("mast", frame)


def test_a_mount_is_in_its_parent_or_else_from_where_the_lidar_is() -> None:
    place, turn = (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)
    (free,) = SensorOptions(name="eye", xyz=place, rpy=turn).frames(BARE)
    assert (free.parent, free.child, free.rpy) == ("base_footprint", "eye_link", turn)
    assert free.xyz == pytest.approx((0.1 + 0.174, 0.2, 0.3 + 0.798 - 0.2))
    (fixed,) = SensorOptions(name="eye", parent="rocker_L_link", xyz=place, rpy=turn).frames(LEO)
    assert (fixed.parent, fixed.xyz, fixed.rpy) == ("rocker_L_link", place, turn)
