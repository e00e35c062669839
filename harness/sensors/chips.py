"""What sensors on a chip share: a reading of the datum, with errors of a preset or of --noise."""

from collections.abc import Mapping
from typing import ClassVar, TypeVar, Unpack

from pydantic import ConfigDict

from harness.sensors.corruption import AxisErrors, AxisTriad
from harness.sensors.noise import HARDWARE
from harness.sensors.optional import Installation, OptionalSensor, SensorOptions

NO_ERRORS = "none"


class ChipOptions(SensorOptions):
    """Options of a sensor with the errors of a chip.

    Attributes:
        errors: The errors of each preset, NO_ERRORS among them.
        hardware: The preset that --noise hardware stands for.
        preset: Its errors; if left out, those that --noise means.
    """

    errors: ClassVar[Mapping[str, AxisErrors]]
    hardware: ClassVar[str]

    preset: str = ""

    def __init_subclass__(cls, **keywords: Unpack[ConfigDict]) -> None:
        """Makes each set of errors a preset, which says nothing else."""
        super().__init_subclass__(**keywords)
        cls.presets = {name: {} for name in cls.errors}


Chip = TypeVar("Chip", bound=ChipOptions, covariant=True)  # noqa: PLC0105 - the class that it is


class ChipSensor(OptionalSensor[Chip]):
    """A sensor with three equal axes, or with one, whose readings depend on where the datum is."""

    def _begin(self, installation: Installation[Chip]) -> None:
        options, noise = installation.options, installation.noise
        by_noise = options.hardware if noise is not None and noise.name == HARDWARE.name else NO_ERRORS
        self._options, self._datum = options, installation.datum
        self._preset = options.preset or by_noise
        self._errors = options.errors[self._preset]
        self._triad = AxisTriad(self._errors, installation.rng)
