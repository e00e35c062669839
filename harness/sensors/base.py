"""What a sensor is: something that looks at the simulation every so many clock ticks."""

from typing import TYPE_CHECKING

from harness.base.errors import UsageError
from harness.base.sim_time import NANOSECONDS, TICK_NS
from harness.samples import Sample

if TYPE_CHECKING:  # whoever only checks a rate does without MuJoCo
    from harness.physics.simulation import Simulation

HIGHEST_RATE = NANOSECONDS // TICK_NS  # [Hz]: one sample per clock tick


class Sensor:
    """One source of samples, with `period_ticks` clock ticks between two."""

    def __init__(self, simulation: "Simulation", period_ticks: int) -> None:
        self._simulation = simulation
        self.period_ticks = period_ticks

    def due(self, tick: int) -> bool:
        """Returns whether a sample falls on a tick, counted from 1."""
        return tick % self.period_ticks == 0

    def read(self) -> Sample:
        """Returns the reading at the simulation's present time."""
        raise NotImplementedError

    def observe(self) -> None:
        """Takes a tick that has just been simulated into account; called after every tick."""

    def before_reset(self) -> None:
        """Called when the rover is about to be put back to its start."""

    def after_reset(self) -> None:
        """Called when the rover has been put back to its start."""


def period_ticks(rate: int) -> int:
    """Returns the clock ticks between the samples of a sensor with that rate [Hz].

    Raises:
        UsageError: The period is no whole number of clock ticks.
    """
    if rate > 0 and HIGHEST_RATE % rate == 0:
        return HIGHEST_RATE // rate
    valid = [r for r in range(1, HIGHEST_RATE + 1) if HIGHEST_RATE % r == 0]
    nearest = sorted(sorted(valid, key=lambda r: abs(r - rate))[:2])
    raise UsageError(
        f"rate {rate} Hz does not divide the {HIGHEST_RATE} Hz clock; "
        f"nearest valid: {' or '.join(str(r) for r in nearest)}"
    )
