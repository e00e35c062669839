"""What touched what, in words, where a quantity counts contacts."""

from collections.abc import Sequence

from harness.base.sim_time import NANOSECONDS
from harness.scenario.judge import Breach
from harness.scenario.quantities import QUANTITIES, SAMPLED
from harness.truth.traversal import ContactEvent

_CORNERS = {
    "FL": "front left",
    "FR": "front right",
    "RL": "rear left",
    "RR": "rear right",
    "L": "left",
    "R": "right",
}


def contact_of(name: str, breach: Breach, events: Sequence[ContactEvent]) -> str:
    """Returns e.g. ": front left wheel against hazard_3"; nothing if there is nothing to tell.

    Args:
        name: Of the quantity.
        breach: What is wrong with it, and since when.
        events: All contacts of the run; those of one kind do not overlap.
    """
    kind = QUANTITIES[name].contact if name in QUANTITIES else None
    if kind is None or breach.time_s is None:
        return ""
    since = breach.time_s - SAMPLED
    meant = [e for e in events if e.kind == kind and e.end_ns / NANOSECONDS >= since]
    if not meant:
        return ""
    event = min(meant, key=lambda e: e.start_ns)
    return f": {_part(event.part)} against {event.other}"


def _part(name: str) -> str:
    """A part of a rover in words: "wheel_FL" is the front left wheel."""
    kind, _, corner = name.partition("_")
    return f"{_CORNERS[corner]} {kind}" if corner in _CORNERS else name
