"""Quantities of estimated poses by name: pose./TOPIC.WHAT or pose.FRAME->FRAME.WHAT."""

import re
from typing import NamedTuple

from harness.scenario.topic import FULL_NAME

POSE = "pose."
TF, TF_STATIC = "/tf", "/tf_static"
MEASURES = {  # unit, meaning
    "ate": ("m", "RMS distance of positions from the true ones."),
    "ate_aligned": ("m", "The same after the best move and turn of the whole path (Umeyama)."),
    "rpe_1m": ("m", "RMS drift of position over each metre of the true path."),
    "yaw": ("rad", "RMS error of yaw."),
    "yaw_aligned": ("rad", "The same after that move and turn."),
    "nees": ("", "Mean squared error over the covariance, of x, y and yaw: 3 of a consistent filter."),
}
FRAME = r"\w+(?:/\w+)*"
FORM = re.compile(
    rf"pose\.(?:(?P<topic>{FULL_NAME})|(?P<parent>{FRAME})->(?P<child>{FRAME}))\.(?P<what>{'|'.join(MEASURES)})"
)
HINT = f"give pose./TOPIC. or pose.FRAME->FRAME. and one of {', '.join(MEASURES)}"


class PoseQuantity(NamedTuple):
    """What is expected of a topic's poses, or of one frame in another."""

    topic: str
    frames: tuple[str, str] | None
    what: str

    @property
    def topics(self) -> tuple[str, ...]:
        """Where it is heard."""
        return (TF, TF_STATIC) if self.frames else (self.topic,)


def pose_quantity(name: str) -> PoseQuantity | None:
    """Returns the quantity of such a name; None if it is none of a pose."""
    found = FORM.fullmatch(name)
    if found is None:
        return None
    frames = (found["parent"], found["child"]) if found["parent"] else None
    return PoseQuantity(found["topic"] or TF, frames, found["what"])
