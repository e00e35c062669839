"""One line of the validation table: a quantity, what is expected of it and why, what was measured.

What a rover's manoeuvres are to show stands in the section `expected` of its rover.yaml; what follows
from geometry is derived where it is measured.
"""

import math
from dataclasses import dataclass

from harness.robots import RoverSpec
from harness.yaml_file import fill


@dataclass(frozen=True, slots=True)
class Span:
    """Lowest and highest expected value, and where they come from; an open end is infinite."""

    low: float
    high: float
    source: str

    @property
    def tells(self) -> bool:
        """Whether anything is expected."""
        return not (math.isinf(self.low) and math.isinf(self.high))

    def describe(self, digits: int) -> str:
        """Returns the span as text, rounded to so many decimals."""
        low, high = f"{self.low:.{digits}f}", f"{self.high:.{digits}f}"
        if not self.tells:
            return "-"
        if math.isinf(self.low):
            return f"at most {high}"
        if math.isinf(self.high):
            return f"at least {low}"
        return f"{low} to {high}"


@dataclass(frozen=True, slots=True)
class Check:
    """A measured quantity against its span.

    Attributes:
        unit: Of the span and of `measured`; empty for a ratio.
        digits: Decimals worth showing.
    """

    quantity: str
    unit: str
    expected: Span
    measured: float
    digits: int = 3

    @property
    def passed(self) -> bool:
        """Whether the measured value lies in the span, if anything is expected; NaN never does."""
        return not self.expected.tells or self.expected.low <= self.measured <= self.expected.high


def around(value: float, tolerance: float, source: str) -> Span:
    """Returns the span around a value.

    Args:
        value: Its middle.
        tolerance: To either side, in the value's unit.
        source: Where both come from.
    """
    return Span(value - tolerance, value + tolerance, source)


def at_most(value: float, source: str) -> Span:
    """Returns everything up to a value, zero included; for magnitudes."""
    return Span(-math.inf, value, source)


NOTHING_TOLD = Span(-math.inf, math.inf, "nothing is told of it")


@dataclass(frozen=True, slots=True)
class Passage:
    """A place below the rover where rocks may pass, and the height that just does [m].

    Attributes:
        name: What is above it.
        aside: Of the middle of the place, to the left [m].
        radius: Of the largest upright cylinder that no wheel touches [m].
        height: Above flat ground [m].
    """

    name: str
    aside: float
    radius: float
    height: float
    source: str


@dataclass(frozen=True, kw_only=True)
class Expected:
    """Spans of one rover.

    Attributes:
        speed_ratio: Ground speed over commanded speed, within the wheels' limit.
        at_half: Ground speed at a command of 0.5 m/s.
        at_top: Ground speed at a command of 1.0 m/s, the highest of RoboTerrain's RL agents.
        yaw_ratio: Achieved over commanded yaw rate, in place.
        kerb_one_side: Height climbed with the wheels of one side [m].
        rocker_stop: Largest angle of a rocker [rad], of a rover that has some.
        ramp_source: What states the slope climbed, before what it is derived from.
    """

    speed_ratio: Span = NOTHING_TOLD
    at_half: Span = NOTHING_TOLD
    at_top: Span = NOTHING_TOLD
    yaw_ratio: Span = NOTHING_TOLD
    kerb_one_side: Span = NOTHING_TOLD
    rocker_stop: Span = NOTHING_TOLD
    ramp_source: str = ""
    passages: tuple[Passage, ...] = ()


def expected_of(rover: RoverSpec) -> Expected:
    """Returns the spans of a rover; open ones of what its rover.yaml does not tell.

    Raises:
        UsageError: What it tells is not valid.
    """
    return fill(Expected, rover.expected, f"{rover.folder / 'rover.yaml'}: expected")
