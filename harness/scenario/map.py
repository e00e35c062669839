"""Quantities of maps by name: map./TOPIC.WHAT, cell by cell against the world graded for the rover."""

import re
from typing import NamedTuple

from harness.scenario.topic import FULL_NAME

MAP = "map."
MEASURES = {  # meaning
    "false_safe": "Share of the dangerous cells that the map knows and says are free.",
    "false_danger": "Share of the safe cells that the map knows and says are occupied.",
    "coverage": "Share of the map's cells in the world that it knows.",
}
FORM = re.compile(rf"map\.(?P<topic>{FULL_NAME})\.(?P<what>{'|'.join(MEASURES)})")
HINT = f"give map./TOPIC. and one of {', '.join(MEASURES)}, e.g. map./local_costmap/costmap.false_safe"


class MapQuantity(NamedTuple):
    """What is expected of the maps of a topic."""

    topic: str
    what: str


def map_quantity(name: str) -> MapQuantity | None:
    """Returns the quantity of such a name; None if it is none of a map."""
    found = FORM.fullmatch(name)
    return None if found is None else MapQuantity(found["topic"], found["what"])
