"""Quantities of topics by name: topic./NAME.WHAT, which is a measure or a path into its messages."""

import re
from typing import NamedTuple

from harness.sensors.choice import by_default
from harness.sensors.message_types import check_path

TOPIC = "topic."
COUNT, RATE, AGE, LATENCY = "count", "rate", "age", "latency"
MEASURES = {
    COUNT: ("", "Messages in the window."),
    RATE: ("Hz", "Messages in the last second, every 50 ms from 1 s on."),
    AGE: ("s", "From a message's stamp until it is heard."),
    LATENCY: ("s", "From the stamp of the newest message of the topic `of` until this one is heard."),
}
FULL_NAME = r"(?:/[A-Za-z_]\w*)+"
PATTERN = rf"topic\.{FULL_NAME}\.[A-Za-z][\w.\[\]]*"
FORM = re.compile(rf"topic\.(?P<topic>{FULL_NAME})\.(?P<what>.+)")
HINT = f"give topic./NAME. and one of {', '.join(MEASURES)}, or a field, e.g. topic./scan.rate"
OWN = {f"/{topic.name}": topic.message_type for row in by_default() for topic in row.topics}


class TopicQuantity(NamedTuple):
    """What is expected of a topic: one of MEASURES, or a path into its messages."""

    topic: str
    what: str

    @property
    def path(self) -> str | None:
        """The path into its messages; None of a measure."""
        return None if self.what in MEASURES else self.what


def topic_quantity(name: str) -> TopicQuantity | None:
    """Returns the quantity of such a name; None if it is none of a topic."""
    found = FORM.fullmatch(name)
    return TopicQuantity(found["topic"], found["what"]) if found else None


def check_topic(name: str) -> str | None:
    """Returns what is wrong with the name of a quantity of a topic, as far as that is known up front."""
    quantity = topic_quantity(name)
    if quantity is None:
        return f"quantity '{name}' is no quantity of a topic; {HINT}"
    return check_messages(quantity, OWN.get(quantity.topic, ""))


def check_messages(quantity: TopicQuantity, type_name: str) -> str | None:
    """Returns why messages of a type do not have a quantity; None if they do, or nobody knows.

    Args:
        quantity: Of their topic.
        type_name: As in sensor_msgs/msg/Imu; "" if it is not known yet.
    """
    if quantity.what == AGE:
        if check_path(type_name, "header.stamp.sec") is not None:
            return f"messages of {quantity.topic} have no stamp, so no age ({type_name})"
        return None
    problem = None if quantity.path is None else check_path(type_name, quantity.path)
    if problem is None:
        return None
    measures = "" if "." in quantity.what else f"; measures: {', '.join(MEASURES)}"
    return f"{quantity.topic}: {problem}{measures}"
