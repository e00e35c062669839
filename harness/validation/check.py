"""One line of the validation table: a quantity, what is expected of it and why, what was measured."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Span:
    """Lowest and highest expected value, and where they come from; an open end is infinite."""

    low: float
    high: float
    source: str

    def describe(self, digits: int) -> str:
        """The span as text, rounded to so many decimals."""
        low, high = f"{self.low:.{digits}f}", f"{self.high:.{digits}f}"
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
        """Whether the measured value lies in the span; NaN never does."""
        return self.expected.low <= self.measured <= self.expected.high


def around(value: float, tolerance: float, source: str) -> Span:
    """The span of a value with an absolute tolerance to either side."""
    return Span(value - tolerance, value + tolerance, source)


def at_most(value: float, source: str) -> Span:
    """Everything up to a value, zero included; for magnitudes."""
    return Span(-math.inf, value, source)


def at_least(value: float, source: str) -> Span:
    """Everything from a value on."""
    return Span(value, math.inf, source)
