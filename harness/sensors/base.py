"""What a sensor is: something that looks at the simulation every so many clock ticks."""

from typing import Protocol

from harness.errors import UsageError
from harness.samples import Sample
from harness.sim_time import NANOSECONDS, TICK_NS

HIGHEST_RATE = NANOSECONDS // TICK_NS  # [Hz]: one sample per clock tick


class Sensor(Protocol):
    """One source of samples.

    Attributes:
        period_ticks: Clock ticks between two samples.
    """

    period_ticks: int

    def read(self) -> Sample:
        """The reading at the simulation's present time."""
        ...


def period_ticks(rate: int) -> int:
    """Clock ticks between the samples of a sensor with that rate [Hz].

    Raises:
        UsageError: The period is no whole number of clock ticks.
    """
    if rate > 0 and HIGHEST_RATE % rate == 0:
        return HIGHEST_RATE // rate
    valid = [r for r in range(1, HIGHEST_RATE + 1) if HIGHEST_RATE % r == 0]
    nearest = sorted(sorted(valid, key=lambda r: abs(r - rate))[:2])
    message = (
        f"rate {rate} Hz does not divide the {HIGHEST_RATE} Hz clock; "
        f"nearest valid: {' or '.join(str(r) for r in nearest)}"
    )
    raise UsageError(message)
