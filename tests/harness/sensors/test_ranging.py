"""What is valid for all that measure along rays, at the edges of what is."""

import math
from dataclasses import dataclass
from typing import Any

import pytest

from harness.base.errors import UsageError
from harness.sensors.corruption import RangeErrors
from harness.sensors.ranging import RangeOptions, check_span


@dataclass(frozen=True, kw_only=True)
class Beams(RangeOptions):
    """Of a sensor with so many rays."""

    range_min: float = 1.0
    range_max: float = 2.0
    count: int = 1

    @property
    def rays(self) -> int:
        """As it was told."""
        return self.count


LIMITS, NOISE = r"range_min .* m and range_max .* m are not valid; give 0 or more", r"noise is not valid"


@pytest.mark.parametrize(
    ("told", "message"),
    [
        ({"range_min": 0.0, "range_max": 1e-3}, ""),
        ({"range_min": -1e-3}, LIMITS),
        ({"range_min": 2.0}, LIMITS),
        ({"range_min": math.nan}, LIMITS),
        ({"range_max": math.inf}, LIMITS),
        ({"noise": RangeErrors(white=0.1, step=0.2, dropout=1.0)}, ""),
        ({"noise": RangeErrors(white=-1e-9)}, NOISE),
        ({"noise": RangeErrors(step=-1e-9)}, NOISE),
        ({"noise": RangeErrors(dropout=-1e-9)}, NOISE),
        ({"noise": RangeErrors(dropout=1.01)}, rf"{NOISE}; give white and step of 0 m or more, dropout"),
        ({"count": 500_000}, ""),
        ({"count": 500_001}, r"^500,001 rays a reading are not valid; give 1 to 500,000$"),
        ({"count": 0}, r"0 rays a reading"),
        ({"rate": 30}, r"rate 30 Hz"),
    ],
)
def test_limits_noise_and_number_of_rays_are_checked(told: dict[str, Any], message: str) -> None:
    if not message:
        return Beams(name="x", **told).check()
    with pytest.raises(UsageError, match=message):
        return Beams(name="x", **told).check()


@pytest.mark.parametrize(
    ("low", "high", "valid"),
    [
        (-1.5, 1.5, True),
        (-1.50009, 1.50009, True),  # as somebody writes it who rounds
        (-1.5002, 1.0, False),
        (-1.0, 1.5002, False),
        (0.5, 0.5, False),
        (0.5, 0.4, False),
        (math.nan, 1.0, False),
    ],
)
def test_a_span_goes_upwards_and_no_farther_than_it_may(low: float, high: float, valid: bool) -> None:
    if valid:
        return check_span("it", low, high, 1.5)
    told = f"it from {low:g} to {high:g} rad is not valid; give a lower angle .*, from -1.5 to 1.5"
    with pytest.raises(UsageError, match=told):
        return check_span("it", low, high, 1.5)
