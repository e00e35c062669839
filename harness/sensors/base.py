"""What a sensor is: something that looks at the simulation every so many clock ticks."""

from typing import TYPE_CHECKING

from harness.samples import Sample

if TYPE_CHECKING:  # whoever only checks a rate does without MuJoCo
    from harness.physics.simulation import Simulation


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
