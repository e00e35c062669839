"""The whole suite: every manoeuvre for one rover and one seed."""

from collections.abc import Callable, Iterator

from harness.robots import RoverSpec
from harness.validation import climbing, driving, square, stability, standing
from harness.validation.check import Check

Manoeuvres = Callable[[RoverSpec, int], Iterator[Check]]
SUITE: tuple[Manoeuvres, ...] = (
    standing.checks,
    driving.checks,
    square.checks,
    climbing.checks,
    stability.checks,
)


def validate(rover: RoverSpec, seed: int) -> list[Check]:
    """Drives every manoeuvre; the same seed gives the same figures."""
    return [check for manoeuvres in SUITE for check in manoeuvres(rover, seed)]
