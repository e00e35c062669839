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
    """Straight into it."""

    summary: ClassVar[str] = "drives into hazards head on (knowing where they are)"

    def offset(self, width: float) -> float:
        """Through the middle or a little beside it [m]."""
        return self.rng.uniform(-HEAD_ON, HEAD_ON) * width


class ReverseInto(Ram):
    """Backwards into it."""

    summary: ClassVar[str] = "drives into hazards backwards (knowing where they are)"

    def random_speed(self) -> float:
        """Backwards [m/s]."""
        return -super().random_speed()


class PassBy(StagedEncounter):
    """Past it, close but without touching."""

    summary: ClassVar[str] = "passes hazards closely without touching (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = PASSING_GAP

    def offset(self, width: float) -> float:
        """On its left or right [m]."""
        side = math.copysign(1.0, self.rng.uniform(-1.0, 1.0))
        return side * (width + self.rng.uniform(*self.gap))


class Graze(PassBy):
    """Along its flank."""

    summary: ClassVar[str] = "scrapes along hazards with its side (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = (-GRAZE_OVERLAP[1], -GRAZE_OVERLAP[0])


class Swing(PassBy):
    """Beside it, and then round: the corners reach farther than the sides."""

    summary: ClassVar[str] = "turns in place beside hazards (knowing where they are)"
    gap: ClassVar[tuple[float, float]] = SWING_GAP

    def act(self, meeting: Meeting) -> Iterator[Twist]:
        """Stops beside the hazard's middle and turns one way, then the other."""
        yield from self.follow(meeting, 0.0)
        for rate in (self.rover.cruise_yaw_rate, -self.rover.cruise_yaw_rate):
            yield from self.spin(SWING_TIME, rate)
