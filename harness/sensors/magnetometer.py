"""A magnetometer: the Earth's field at the datum in the rover's axes, with the errors of its chip."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.errors import find_named
from harness.samples import Vector3, plain_value
from harness.sensors.base import Sensor
from harness.sensors.corruption import AxisErrors, AxisTriad
from harness.sensors.geodesy import Datum

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    from harness.physics.simulation import Simulation

MICRO = 1e-6
PRESETS = {
    "none": AxisErrors(),
    # Bosch BST-BMM150-DS001: 0.3 uT RMS in its high-accuracy preset, 0.3 uT resolution, +-1300 uT. What is
    # left of the offset when its hard iron is calibrated, 2 uT, is taken as a standard deviation.
    "bmm150": AxisErrors(white=0.3 * MICRO, bias=2.0 * MICRO, step=0.3 * MICRO, limit=1300 * MICRO),
}


@plain_value
class MagneticField:
    """Flux density in the sensor's axes; names are those of sensor_msgs/MagneticField.

    Attributes:
        magnetic_field: x, y, z [T].
        magnetic_field_covariance: By rows [T^2]; zeros if there is no noise.
    """

    stamp_ns: int
    magnetic_field: Vector3
    magnetic_field_covariance: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class MagnetometerOptions:
    """Of a magnetometer.

    Attributes:
        noise: One of PRESETS.
        field: East, north, up at the datum [T]; empty for the Earth's dipole there.
    """

    noise: str = "none"
    field: tuple[float, ...] = ()

    def check(self) -> None:
        """Checks the values.

        Raises:
            UsageError: One is not valid; the message names those that are.
        """
        find_named("magnetometer noise", self.noise, PRESETS)


class MagnetometerSensor(Sensor):
    """The magnetometer, in the axes of the model frame; nothing of the rover is magnetic."""

    def __init__(
        self,
        simulation: "Simulation",
        datum: Datum,
        options: MagnetometerOptions,
        rng: np.random.Generator,
        period_ticks: int,
    ) -> None:
        super().__init__(simulation, period_ticks)
        self._field = np.array(options.field or datum.magnetic_field())
        errors = PRESETS[options.noise]
        self._errors = AxisTriad(errors, rng)
        self._covariance = tuple((errors.variance * np.eye(3)).ravel().tolist())

    def read(self) -> MagneticField:
        """Returns the field where the rover is, in its axes [T]."""
        simulation = self._simulation
        x, y, z = (self._field @ simulation.rotation()).tolist()
        stamp_ns = simulation.time_ns
        return MagneticField(stamp_ns, self._errors.corrupt((x, y, z), stamp_ns), self._covariance)
