"""Quantities of topics, estimated poses and maps by name, e.g. topic./scan.rate or map./map.coverage.

topic./NAME.WHAT, WHAT being a measure or a path into its messages; pose./TOPIC.WHAT or
pose.FRAME->FRAME.WHAT; map./TOPIC.WHAT, cell by cell against the world graded for the rover.
"""

import re
from typing import NamedTuple

from harness.sensors.choice import by_default
from harness.sensors.message_types import check_path

TOPIC, POSE, MAP = "topic.", "pose.", "map."
COUNT, RATE, AGE, LATENCY = "count", "rate", "age", "latency"
OF_TOPICS = {  # unit, meaning
    COUNT: ("", "Messages in the window."),
    RATE: ("Hz", "Messages in the last second, every 50 ms from 1 s on."),
    AGE: ("s", "From a message's stamp until it is heard."),
    LATENCY: ("s", "From the stamp of the newest message of the topic `of` until this one is heard."),
}
OF_POSES = {  # unit, meaning
    "ate": ("m", "RMS distance of positions from the true ones."),
    "ate_aligned": ("m", "The same after the best move and turn of the whole path (Umeyama)."),
    "rpe_1m": ("m", "RMS drift of position over each metre of the true path."),
    "yaw": ("rad", "RMS error of yaw."),
    "yaw_aligned": ("rad", "The same after that move and turn."),
    "nees": ("", "Mean squared error over the covariance, of x, y and yaw: 3 of a consistent filter."),
}
OF_MAPS = {  # meaning
    "false_safe": "Share of the dangerous cells that the map knows and says are free.",
    "false_danger": "Share of the safe cells that the map knows and says are occupied.",
    "coverage": "Share of the map's cells in the world that it knows.",
}
FULL_NAME, FRAME = r"(?:/[A-Za-z_]\w*)+", r"\w+(?:/\w+)*"
PATTERN = rf"topic\.{FULL_NAME}\.[A-Za-z][\w.\[\]]*"
TOPIC_FORM = re.compile(rf"topic\.(?P<topic>{FULL_NAME})\.(?P<what>.+)")
POSE_FORM = re.compile(
    rf"pose\.(?:(?P<topic>{FULL_NAME})|(?P<parent>{FRAME})->(?P<child>{FRAME}))\.(?P<what>{'|'.join(OF_POSES)})"
)
MAP_FORM = re.compile(rf"map\.(?P<topic>{FULL_NAME})\.(?P<what>{'|'.join(OF_MAPS)})")
TF, TF_STATIC = "/tf", "/tf_static"
OWN = {f"/{topic.name}": topic.message_type for row in by_default() for topic in row.topics}


class TopicQuantity(NamedTuple):
    """What is expected of a topic: one of OF_TOPICS, or a path into its messages."""

    topic: str
    what: str

    @property
    def path(self) -> str | None:
        """The path into its messages; None of a measure."""
        return None if self.what in OF_TOPICS else self.what


class PoseQuantity(NamedTuple):
    """What is expected of a topic's poses, or of one frame in another: one of OF_POSES."""

    topic: str
    frames: tuple[str, str] | None
    what: str

    @property
    def topics(self) -> tuple[str, ...]:
        """Where it is heard."""
        return (TF, TF_STATIC) if self.frames else (self.topic,)


class MapQuantity(NamedTuple):
    """What is expected of the maps of a topic: one of OF_MAPS."""

    topic: str
    what: str


def topic_quantity(name: str) -> TopicQuantity | None:
    """Returns the quantity of such a name; None if it is none of a topic."""
    found = TOPIC_FORM.fullmatch(name)
    return TopicQuantity(found["topic"], found["what"]) if found else None


def pose_quantity(name: str) -> PoseQuantity | None:
    """Returns the quantity of such a name; None if it is none of a pose."""
    found = POSE_FORM.fullmatch(name)
    if found is None:
        return None
    frames = (found["parent"], found["child"]) if found["parent"] else None
    return PoseQuantity(found["topic"] or TF, frames, found["what"])


def map_quantity(name: str) -> MapQuantity | None:
    """Returns the quantity of such a name; None if it is none of a map."""
    found = MAP_FORM.fullmatch(name)
    return MapQuantity(found["topic"], found["what"]) if found else None


def check_heard(name: str) -> str | None:
    """Returns what is wrong with a name of a topic, pose or map, as far as is known up front."""
    if name.startswith(TOPIC):
        if (quantity := topic_quantity(name)) is not None:
            return check_messages(quantity, OWN.get(quantity.topic, ""))
        kind, hint = "quantity of a topic", f"topic./NAME. and one of {', '.join(OF_TOPICS)}, or a field"
        return f"quantity '{name}' is no {kind}; give {hint}, e.g. topic./scan.rate"
    if name.startswith(POSE):
        hint = f"pose./TOPIC. or pose.FRAME->FRAME. and one of {', '.join(OF_POSES)}"
        return None if pose_quantity(name) else f"quantity '{name}' is none of a pose; give {hint}"
    hint = f"map./TOPIC. and one of {', '.join(OF_MAPS)}, e.g. map./local_costmap/costmap.false_safe"
    return None if map_quantity(name) else f"quantity '{name}' is none of a map; give {hint}"


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
    measures = "" if "." in quantity.what else f"; measures: {', '.join(OF_TOPICS)}"
    return f"{quantity.topic}: {problem}{measures}"
