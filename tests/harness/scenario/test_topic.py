"""Quantities of topics by name: what is told of those that cannot be, before a run and in it."""

import re

import pytest

from harness.scenario.quantities import check_name
from harness.scenario.topic import PATTERN, TopicQuantity, check_messages, topic_quantity


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("topic./scan.rate", None),
        ("topic./my_node/answer_2.count", None),
        ("topic./my/own.deep.field[3].x", None),
        ("topic./scan.ranges[0]", None),
        ("topic./imu/data.age", None),
        ("topic./cmd_vel.linear.x", None),
        (
            "topic.scan.rate",
            "quantity 'topic.scan.rate' is no quantity of a topic; give topic./NAME.",
        ),
        (
            "topic./scan",
            "quantity 'topic./scan' is no quantity of a topic; give topic./NAME.",
        ),
        ("topic./a//b.rate", "quantity 'topic./a//b.rate' is no quantity of a topic"),
        ("topic./scan.rat", "/scan: field 'rat' does not exist; available: header, angle_min"),
        ("topic./my/own.a b", "/my/own: 'a b' is no path to a field"),
        ("topic./imu/data.orientation.w.x", "/imu/data: there is nothing below the numbers"),
        ("topic./rover/truth/contact.age", "messages of /rover/truth/contact have no stamp, so no age"),
    ],
)
def test_a_name_is_understood_or_told(name: str, told: str | None) -> None:
    problem = check_name(name)
    assert problem is None if told is None else str(problem).startswith(told)
    assert told is not None or re.fullmatch(PATTERN, name)


def test_the_measures_are_told_where_one_was_meant() -> None:
    assert str(check_name("topic./scan.rat")).endswith("; measures: count, rate, age, latency")
    assert "measures" not in str(check_name("topic./cmd_vel.linear.w"))


def test_a_name_has_a_topic_and_what_is_asked_of_it() -> None:
    rate, field = topic_quantity("topic./a/b.rate"), topic_quantity("topic./a/b.rate.x")
    assert rate == ("/a/b", "rate")
    assert rate.path is None
    assert field == ("/a/b", "rate.x")
    assert field.path == "rate.x"
    assert topic_quantity("truth.speed") is None


def test_of_a_type_that_turns_up_in_a_run_the_same_is_told() -> None:
    speed = TopicQuantity("/cmd_vel", "linear.x")
    assert check_messages(speed, "geometry_msgs/msg/Twist") is None
    told = check_messages(speed, "geometry_msgs/msg/TwistStamped")
    assert str(told).startswith("/cmd_vel: field 'linear' does not exist; available: header, twist")
    assert check_messages(speed, "my_msgs/msg/Mine") is None
