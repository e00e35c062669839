"""What users write, as the values that stations take."""

from collections.abc import Iterable, Sequence
from typing import Any

from harness.faults.base import Fault
from harness.faults.lookup import find_faults
from harness.sensors.table import SensorRow
from harness.spec.actor import parse_actor
from harness.spec.fault import parse_fault
from harness.world.actors.people import Pedestrian, pedestrians


def parse_faults(
    texts: Iterable[str], rows: Iterable[SensorRow] | None = None
) -> tuple[Fault[Any], ...]:
    """Returns the faults that texts of --fault stand for."""
    return find_faults(map(parse_fault, texts), rows)


def parse_actors(texts: Iterable[str], folders: Sequence[str] = ()) -> tuple[Pedestrian, ...]:
    """Returns the people that texts of --actor stand for."""
    return pedestrians(tuple(map(parse_actor, texts)), folders)
