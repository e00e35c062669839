"""A barometer: the pressure of the standard atmosphere at the rover's altitude."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from harness.errors import find_named
from harness.samples import plain_value
from harness.sensors.base import Sensor
from harness.sensors.corruption import AxisErrors, AxisTriad
from harness.sensors.geodesy import Datum

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    from harness.physics.simulation import Simulation

# ISO 2533, lowest layer: pressure [Pa] and temperature [K] at sea level, lapse rate [K/m], standard
# gravity [m/s^2], specific gas constant of dry air [J/(kg K)].
SEA_LEVEL, TEMPERATURE, LAPSE, GRAVITY, GAS = 101_325.0, 288.15, 0.0065, 9.80665, 287.05287
PRESETS = {
    "none": AxisErrors(),
    # Bosch BST-BMP280-DS001: absolute accuracy +-1 hPa taken as three deviations, 1.3 Pa RMS at full
    # bandwidth, 0.16 Pa resolution. The walk, which is the weather's, is an estimate: 1 hPa in 3 h.
    "bmp280": AxisErrors(white=1.3, bias=100.0 / 3.0, walk=1.0, step=0.16),
}


@plain_value
class Pressure:
    """Static pressure; names are those of sensor_msgs/FluidPressure.

    Attributes:
        fluid_pressure: [Pa].
        variance: [Pa^2]; 0 if there is no noise.
    """

    stamp_ns: int
    fluid_pressure: float
    variance: float


@dataclass(frozen=True, kw_only=True)
class BarometerOptions:
    """Of a barometer.

    Attributes:
        noise: One of PRESETS.
    """

    noise: str = "none"

    def check(self) -> None:
        """Checks the values.

        Raises:
            UsageError: One is not valid; the message names those that are.
        """
        find_named("barometer noise", self.noise, PRESETS)


def standard_pressure(altitude: float) -> float:
    """Returns the pressure of the standard atmosphere at an altitude up to 11 km [m], in Pa."""
    warmth = 1.0 - LAPSE * altitude / TEMPERATURE
    return float(SEA_LEVEL * warmth ** (GRAVITY / (GAS * LAPSE)))


class BarometerSensor(Sensor):
    """The barometer, at the origin of the model frame; the geoid is taken for the ellipsoid."""

    def __init__(
        self,
        simulation: "Simulation",
        datum: Datum,
        options: BarometerOptions,
        rng: np.random.Generator,
        period_ticks: int,
    ) -> None:
        super().__init__(simulation, period_ticks)
        self._altitude = datum.altitude
        self._variance = PRESETS[options.noise].variance
        self._errors = AxisTriad(PRESETS[options.noise], rng)

    def read(self) -> Pressure:
        """Returns the pressure where the rover is."""
        simulation = self._simulation
        pressure = standard_pressure(self._altitude + simulation.position[2])
        read, _, _ = self._errors.corrupt((pressure, 0.0, 0.0), simulation.time_ns)
        return Pressure(simulation.time_ns, read, self._variance)
