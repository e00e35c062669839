"""One line of the validation table: a quantity, what is expected of it and why, what was measured.

What a rover's manoeuvres are to show stands in the section `expected` of its rover.yaml; what follows
from geometry is derived where it is measured.
"""

import math
from dataclasses import dataclass

from harness.robots.sections import Span


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
        return self.expected.is_open or self.expected.low <= self.measured <= self.expected.high


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
