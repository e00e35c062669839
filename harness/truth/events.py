"""What a rover touched: one value for each contact event with a hazard, a rock or the ground."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

from harness.samples import Vector3, sent_by_fields
from harness.sim_time import NANOSECONDS

if TYPE_CHECKING:  # loads MuJoCo, which who only publishes events does without
    from harness.physics.contacts import ContactKind

EVENT_GAP_NS = NANOSECONDS // 2  # contacts of a kind closer together than this are one event


@sent_by_fields
@dataclass(frozen=True, slots=True)
class ContactEvent:
    """Contacts of one kind, none of them more than EVENT_GAP_NS after the one before.

    Attributes:
        kind: With what: any part with a hazard, any part with a rock, or the body (all but the
            wheels) with the ground, which is a scrape.
        start_ns: Start of the clock tick in which it began; `end_ns` is the end of that in which it
            ended, so that no event is shorter than a tick.
        part: Which part of the rover, as its model names it, e.g. "wheel_FL", "chassis".
        other: Name of the obstacle in the model, e.g. "hazard_3", or "ground".
        force: Largest normal force at one contact point in one physics step [N]; `part`, `other` and
            `point` are those of that moment.
        point: Where on the rover, in its model frame [m].
    """

    kind: "ContactKind"
    start_ns: int
    end_ns: int
    part: str
    other: str
    force: float
    point: Vector3
