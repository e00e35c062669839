"""What went wrong with a rover in a run, in words: it tipped over, hit something, left the map."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from harness.base.sim_time import NANOSECONDS

if TYPE_CHECKING:
    from harness.episode.result import RunResult

WHEEL = "wheel"  # in the names of parts that are to touch rocks
LEFT_THE_MAP = "edge of the map"  # in what physics says of it
Kind = Literal["tipped_over", "hazard", "rock", "scrape", "left_map"]
KINDS: dict[Kind, str] = {
    "tipped_over": "it lay on its side or roof",
    "hazard": "it touched a post, boulder, wall or person",
    "rock": "its body, not a wheel, struck a rock",
    "scrape": "its body touched the ground",
    "left_map": "it reached the edge of the map",
}
CONTACTS: dict[Kind, str] = {
    "hazard": "hit {other}",
    "rock": "struck {other} with its {part}",
    "scrape": "scraped the ground with its {part}",
}
# The ground is touched in any rough drive.
SERIOUS: tuple[Kind, ...] = ("tipped_over", "hazard", "rock", "left_map")


@dataclass(frozen=True)
class Mishap:
    """One thing that went wrong.

    Attributes:
        kind: One of KINDS.
        time_s: Simulated time at which it did first [s].
        text: What to tell, e.g. "hit hazard_3 at 6.2 s".
    """

    kind: Kind
    time_s: float
    text: str


def mishaps(result: "RunResult", kinds: tuple[Kind, ...] = SERIOUS) -> tuple[Mishap, ...]:
    """Returns what went wrong in a run, of each kind the first time, in the order of time."""
    every = sorted(_every(result), key=lambda mishap: mishap.time_s)
    return tuple(mishap for mishap in every if mishap.kind in kinds)


def _every(result: "RunResult") -> Iterator[Mishap]:
    along = result.along
    if not math.isnan(along.tipped_over_s):
        yield _mishap("tipped_over", along.tipped_over_s, "tipped over")
    if result.failure is not None and LEFT_THE_MAP in result.failure:
        yield _mishap("left_map", result.simulated_s, "left the map")
    for kind, verb in CONTACTS.items():
        events = [
            e for e in along.events if e.kind == kind and (kind != "rock" or WHEEL not in e.part.lower())
        ]
        if events:
            first = events[0]
            often = f", {len(events)} times in all" if len(events) > 1 else ""
            event = verb.format(other=first.other, part=first.part)
            yield _mishap(kind, first.start_ns / NANOSECONDS, event, often)


def _mishap(kind: Kind, time_s: float, event: str, more: str = "") -> Mishap:
    return Mishap(kind, time_s, f"{event} at {time_s:.1f} s{more}")
