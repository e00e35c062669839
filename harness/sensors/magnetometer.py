"""Magnetometer: the Earth's magnetic field at the datum, in the sensor's axes."""

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from harness.base.errors import UsageError
from harness.samples import Vector3
from harness.sensors.chips import NO_ERRORS, ChipOptions, ChipSensor
from harness.sensors.corruption import AxisErrors
from harness.sensors.optional import Rate
from harness.spec.value import checked
from harness.world.geodesy import MAGNETIC_YEARS

MICRO = 1e-6
STRONGEST = 1e-3  # [T]: ten times what the Earth has anywhere
COMPASSES = {
    NO_ERRORS: AxisErrors(),
    # Bosch BMM150, at second hand (docs/sensors.md); its data sheet was not read: 0.3 uT RMS at high
    # accuracy, 0.3 uT resolution, +-1300 uT along x and y (along z more, which the Earth does not
    # need). What is left of the offset when its hard iron is calibrated, 2 uT, is taken as a standard
    # deviation.
    "bmm150": AxisErrors(white=0.3 * MICRO, bias=2.0 * MICRO, step=0.3 * MICRO, limit=1300 * MICRO),
}


@dataclass(frozen=True, slots=True)
class MagneticField:
    """Flux density in the sensor's axes; names are those of sensor_msgs/MagneticField."""

    stamp_ns: int
    sensor: str
    magnetic_field: Vector3  # x, y, z [T]
    magnetic_field_covariance: tuple[float, ...]  # by rows [T^2]; zeros if there is no noise


def _check_field(field: tuple[float, ...]) -> None:
    if len(field) not in (0, 3) or not all(abs(value) <= STRONGEST for value in field):
        raise UsageError(
            f"field {list(field)} is not valid; give east, north and up in tesla, "
            f"each within {STRONGEST:g}, e.g. [2.9e-6, 20.9e-6, -42.1e-6]"
        )


class MagnetometerOptions(ChipOptions):
    """Options of a magnetometer.

    Attributes:
        preset: Its errors: `none`, `bmm150`. If left out, `--noise hardware` means that chip's, and all
            else none.
        field: East, north, up at the datum [T]; empty for what the World Magnetic Model says there.
        year: Of the model, decimal: 2025 up to 2030.
    """

    errors = COMPASSES
    hardware = "bmm150"

    field: Annotated[tuple[float, ...], AfterValidator(checked(_check_field))] = ()
    year: Annotated[float, Field(ge=MAGNETIC_YEARS[0], lt=MAGNETIC_YEARS[1])] = 2026.0
    rate: Rate = 20


class MagnetometerSensor(ChipSensor[MagnetometerOptions]):
    """The magnetometer; nothing of the rover is magnetic."""

    @cached_property
    def _field(self) -> NDArray[np.float64]:
        """The field in the world's axes [T]."""
        return np.array(self._options.field or self._datum.magnetic_field(self._options.year))

    def read(self) -> MagneticField:
        """Returns the field in the sensor's axes."""
        stamp_ns = self._simulation.time_ns
        # Summed row by row: what BLAS sums a product of a vector in differs between makes of processors.
        x, y, z = (self._field[:, None] * self.pose()[1:]).sum(axis=0).tolist()
        read = self._triad.corrupt((x, y, z), stamp_ns)
        covariance = (self._errors.variance * np.eye(3)).ravel().tolist()
        return MagneticField(stamp_ns, self.name, read, tuple(covariance))
