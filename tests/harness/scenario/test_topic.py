"""Quantities of topics by name: what is told of those that cannot be, before a run and in it."""

from harness.scenario.quantities import check_name
from harness.scenario.topic import TopicQuantity, check_messages, topic_quantity


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
