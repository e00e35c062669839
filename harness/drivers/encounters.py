"""The ways to meet a hazard: head on, in reverse, grazing, swinging round beside it, just missing it."""

import math
from collections.abc import Iterator
from typing import ClassVar

from harness.drivers.staged import Meeting, StagedEncounter
from harness.samples import Twist

HEAD_ON = 0.6  # of the width within which rover and hazard meet
GRAZE_OVERLAP = (0.0, 0.08)  # [m] by which the rover's side would enter the hazard
PASSING_GAP = (0.04, 0.5)  # [m] between the rover's side and the hazard
SWING_GAP = (0.0, 0.1)  # [m], less than what the corners stand out beyond the sides when turning
SWING_TIME = 3.0  # [s]


class Ram(StagedEncounter):
    """Drives straight into the hazard."""

    summary: ClassVar[str] = "drives into hazards head on (knowing where they are)"

    def offset(self, width: float) -> float:
        """Returns the offset of the path from the hazard's middle, to the left [m]: little or none."""
        return self.rng.uniform(-HEAD_ON, HEAD_ON) * width


class ReverseInto(Ram):
    """Drives backwards into the hazard."""

    summary: ClassVar[str] = "drives into hazards backwards (knowing where they are)"

    def random_speed(self) -> float:
        """Returns a negative speed [m/s]."""
        return -super().random_speed()


class PassBy(StagedEncounter):
    """Passes the hazard closely without touching it."""

    summary: ClassVar[str] = "passes hazards closely without touching (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = PASSING_GAP

    def offset(self, width: float) -> float:
        """Returns the offset of the path from the hazard's middle, to the left [m]: on a random side."""
        side = math.copysign(1.0, self.rng.uniform(-1.0, 1.0))
        return side * (width + self.rng.uniform(*self.gap))


class Graze(PassBy):
    """Scrapes along the hazard's flank."""

    summary: ClassVar[str] = "scrapes along hazards with its side (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = (-GRAZE_OVERLAP[1], -GRAZE_OVERLAP[0])


class Swing(PassBy):
    """Stops beside the hazard and turns: the rover's corners reach farther than its sides."""

    summary: ClassVar[str] = "turns in place beside hazards (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = SWING_GAP

    def act(self, meeting: Meeting) -> Iterator[Twist]:
        """Stops beside the hazard's middle and turns one way, then the other."""
        yield from self.follow(meeting, 0.0)
        for rate in (self.rover.cruise_yaw_rate, -self.rover.cruise_yaw_rate):
            yield from self.spin(SWING_TIME, rate)
