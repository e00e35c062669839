"""Quantities of topics, estimated poses and maps by name, e.g. topic./scan.rate or map./map.coverage.

topic./NAME.WHAT, WHAT being a measure or a path into its messages; pose./TOPIC.WHAT or
pose.FRAME->FRAME.WHAT; map./TOPIC.WHAT, cell by cell against the world graded for the rover.
"""

import re
from typing import NamedTuple

from harness.base.message_types import check_path
from harness.sensors.choice import by_default

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
FORMS = {
    TOPIC: re.compile(rf"topic\.(?P<topic>{FULL_NAME})\.(?P<what>.+)"),
    POSE: re.compile(
        rf"pose\.(?:(?P<topic>{FULL_NAME})|(?P<parent>{FRAME})->(?P<child>{FRAME}))\.(?P<what>{'|'.join(OF_POSES)})"
    ),
    MAP: re.compile(rf"map\.(?P<topic>{FULL_NAME})\.(?P<what>{'|'.join(OF_MAPS)})"),
}
OF_TARGET = re.compile(r"truth\.target\.(?P<name>[A-Za-z]\w*)\.(?P<what>distance|stop_distance)")
HINTS = {  # of a name that has no such form: what it is not, and what to give
    TOPIC: (
        "no quantity of a topic",
        f"topic./NAME. and one of {', '.join(OF_TOPICS)}, or a field, e.g. topic./scan.rate",
    ),
    POSE: ("none of a pose", f"pose./TOPIC. or pose.FRAME->FRAME. and one of {', '.join(OF_POSES)}"),
    MAP: (
        "none of a map",
        f"map./TOPIC. and one of {', '.join(OF_MAPS)}, e.g. map./local_costmap/costmap.false_safe",
    ),
}
TF, TF_STATIC = "/tf", "/tf_static"
OWN = {f"/{topic.name}": topic.message_type for row in by_default() for topic in row.topics}


class HeardQuantity(NamedTuple):
    """What is expected of the messages of a topic, or of the transforms between two frames.

    Attributes:
        topic: Where they are heard; /tf of frames.
        measure: One of OF_TOPICS or a path into messages, of OF_POSES or of OF_MAPS.
        frames: Parent and child, of transforms.
    """

    topic: str
    measure: str
    frames: tuple[str, str] | None = None

    @property
    def path(self) -> str | None:
        """The path into messages of a topic; None of a measure."""
        return None if self.measure in OF_TOPICS else self.measure

    @property
    def topics(self) -> tuple[str, ...]:
        """All topics on which it is heard."""
        return (TF, TF_STATIC) if self.frames else (self.topic,)


def heard_quantity(name: str, kind: str = TOPIC) -> HeardQuantity | None:
    """Returns the quantity of a name; None if it is none of that kind: TOPIC, POSE or MAP."""
    match = FORMS[kind].fullmatch(name)
    if match is None:
        return None
    parts = match.groupdict()
    frames = (parts["parent"], parts["child"]) if parts.get("parent") else None
    return HeardQuantity(parts["topic"] or TF, parts["what"], frames)


def check_heard(name: str) -> str | None:
    """Returns what is wrong with a name of a topic, pose or map, before anything is heard of it."""
    kind = next(kind for kind in FORMS if name.startswith(kind))
    quantity = heard_quantity(name, kind)
    if quantity is None:
        problem, hint = HINTS[kind]
        return f"quantity '{name}' is {problem}; give {hint}"
    return check_messages(quantity, OWN.get(quantity.topic, "")) if kind == TOPIC else None


def check_messages(quantity: HeardQuantity, type_name: str) -> str | None:
    """Returns why messages of a type, "" for any, lack a topic's quantity; None if they have it."""
    if quantity.measure == AGE:
        if check_path(type_name, "header.stamp.sec") is not None:
            return f"messages of {quantity.topic} have no stamp, so no age ({type_name})"
        return None
    problem = None if quantity.path is None else check_path(type_name, quantity.path)
    if problem is None:
        return None
    measures = "" if "." in quantity.measure else f"; measures: {', '.join(OF_TOPICS)}"
    return f"{quantity.topic}: {problem}{measures}"
