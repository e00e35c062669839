"""Barometer: the pressure of the standard atmosphere at the sensor's height."""

from dataclasses import dataclass

from harness.sensors.chips import NO_ERRORS, ChipOptions, ChipSensor
from harness.sensors.corruption import AxisErrors

# ISO 2533, lowest layer: pressure [Pa] and temperature [K] at sea level, lapse rate [K/m], standard
# gravity [m/s^2], specific gas constant of dry air [J/(kg K)].
SEA_LEVEL, TEMPERATURE, LAPSE, GRAVITY, GAS = 101_325.0, 288.15, 0.0065, 9.80665, 287.05287
BAROMETERS = {
    NO_ERRORS: AxisErrors(),
    # Bosch BST-BMP280-DS001: absolute accuracy +-1 hPa (typical), taken as three deviations; 0.16 Pa
    # resolution. 1.3 Pa RMS at full bandwidth is from memory of it, not checked. The walk, which is the
    # weather's, is an estimate: 1 hPa in 3 h.
    "bmp280": AxisErrors(white=1.3, bias=100.0 / 3.0, walk=1.0, step=0.16),
}


@dataclass(frozen=True, slots=True)
class Pressure:
    """Static pressure; names are those of sensor_msgs/FluidPressure."""

    stamp_ns: int
    sensor: str
    fluid_pressure: float  # pressure [Pa], whose variance [Pa^2] is 0 if there is no noise
    variance: float


class BarometerOptions(ChipOptions):
    """Options of a barometer.

    Attributes:
        preset: Its errors: `none`, `bmp280`. If left out, `--noise hardware` means that chip's, and all
            else none.
    """

    errors = BAROMETERS
    hardware = "bmp280"


def standard_pressure(altitude: float) -> float:
    """Returns the pressure of the standard atmosphere at an altitude up to 11 km [m], in Pa."""
    warmth = 1.0 - LAPSE * altitude / TEMPERATURE
    return float(SEA_LEVEL * warmth ** (GRAVITY / (GAS * LAPSE)))


class BarometerSensor(ChipSensor[BarometerOptions]):
    """The barometer; height over the ellipsoid is taken for that over the sea."""

    def read(self) -> Pressure:
        """Returns the pressure where the sensor is."""
        stamp_ns = self._simulation.time_ns
        pressure = standard_pressure(self._datum.altitude + self.pose()[0, 2].item())
        read, _, _ = self._triad.corrupt((pressure, 0.0, 0.0), stamp_ns)
        return Pressure(stamp_ns, self.name, read, self._errors.variance)
