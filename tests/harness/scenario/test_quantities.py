"""Quantities by name."""

import re

import pytest

from harness.scenario.names import PATTERN, HeardQuantity, check_messages
from harness.scenario.quantities import check_name, names


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("truth.speed", None),
        ("log.Obstacle Clearance", None),
        ("truth.sped", "quantity 'truth.sped' does not exist; did you mean 'truth.speed'?"),
        ("log.Timestamp", "quantity 'log.Timestamp' does not exist"),
        ("x", f"quantity 'x' does not exist; available: {', '.join(names())}"),
        ("topic./scan.rate", None),
        ("topic./my_node/answer_2.count", None),
        ("topic./my/own.deep.field[3].x", None),
        ("topic./imu/data.age", None),
        ("topic./cmd_vel.linear.x", None),
        ("topic.scan.rate", "quantity 'topic.scan.rate' is no quantity of a topic; give topic./NAME."),
        ("topic./a//b.rate", "quantity 'topic./a//b.rate' is no quantity of a topic"),
        ("topic./scan.rat", "/scan: field 'rat' does not exist; available: header, angle_min"),
        ("topic./my/own.a b", "/my/own: 'a b' is no path to a field"),
        ("topic./imu/data.orientation.w.x", "/imu/data: there is nothing below the numbers"),
        ("topic./rover/truth/contact.age", "messages of /rover/truth/contact have no stamp, so no age"),
    ],
)
def test_a_name_that_does_not_exist_is_told_with_the_nearest(name: str, told: str | None) -> None:
    problem = check_name(name)
    assert problem is None if told is None else str(problem).startswith(told)
    assert told is not None or not name.startswith("topic.") or re.fullmatch(PATTERN, name)


def test_of_a_type_that_turns_up_in_a_run_the_same_is_said() -> None:
    speed = HeardQuantity("/cmd_vel", "linear.x")
    assert check_messages(speed, "geometry_msgs/msg/Twist") is None
    problem = check_messages(speed, "geometry_msgs/msg/TwistStamped")
    assert str(problem).startswith("/cmd_vel: field 'linear' does not exist; available: header, twist")
    assert check_messages(speed, "my_msgs/msg/Mine") is None
    assert str(check_name("topic./scan.rat")).endswith("; measures: count, rate, age, latency")
