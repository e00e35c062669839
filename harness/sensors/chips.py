"""GNSS, magnetometer, barometer: what they read at the datum, with errors of a preset or of --noise."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, ClassVar, TypeVar, Unpack

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, ConfigDict, Field

from harness.base.errors import UsageError
from harness.samples import Vector3, plain_value
from harness.sensors.corruption import AxisErrors, AxisTriad
from harness.sensors.noise import HARDWARE
from harness.sensors.optional import Installation, OptionalSensor, Rate, SensorOptions
from harness.spec.value import checked
from harness.world.geodesy import MAGNETIC_YEARS

if TYPE_CHECKING:  # the table of sensors does without MuJoCo
    from harness.physics.simulation import Simulation

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

    def __init__(
        self, simulation: "Simulation", installation: Installation[Chip], period_ticks: int
    ) -> None:
        super().__init__(simulation, installation, period_ticks)
        options, noise = installation.options, installation.noise
        by_noise = options.hardware if noise is not None and noise.name == HARDWARE.name else NO_ERRORS
        self._options, self._datum = options, installation.datum
        self._preset = options.preset or by_noise
        self._errors = options.errors[self._preset]
        self._triad = AxisTriad(self._errors, installation.rng)


# Standard deviation along one axis over the radius in which half of the fixes lie: of a circle (CEP), of
# a line (R50).
PER_CEP = 1.0 / math.sqrt(2.0 * math.log(2.0))
PER_R50 = 1.0 / 0.674490
UNKNOWN, DIAGONAL_KNOWN = 0, 2  # sensor_msgs/NavSatFix: COVARIANCE_TYPE_...
FIX, GROUND_BASED = 0, 2  # sensor_msgs/NavSatStatus: STATUS_FIX, STATUS_GBAS_FIX


@plain_value
class GnssFix:
    """Position of the antenna on WGS-84; names and codes are those of sensor_msgs/NavSatFix."""

    stamp_ns: int
    sensor: str
    latitude: float  # [deg], north positive
    longitude: float  # [deg], east positive
    altitude: float  # above the ellipsoid [m]
    position_covariance: tuple[float, ...]  # east, north, up by rows [m^2]; zeros if unknown
    position_covariance_type: int
    fix: int  # the status of NavSatStatus


@dataclass(frozen=True)
class GnssClass:
    """A class of receivers."""

    horizontal: AxisErrors  # errors to the east and to the north [m]
    vertical: float  # how many times larger they are upwards
    fix: int  # what it says of its fixes

    @property
    def covariance(self) -> tuple[float, ...]:
        """Covariance of a fix: east, north, up by rows [m^2]."""
        level = self.horizontal.variance
        return (level, 0.0, 0.0, 0.0, level, 0.0, 0.0, 0.0, level * self.vertical**2)


HALF_OF_RTK = 0.01 * PER_CEP * math.sqrt(0.5)
CLASSES = {
    NO_ERRORS: GnssClass(AxisErrors(), vertical=1.0, fix=FIX),
    # u-blox ZED-F9P (integration manual UBX-18010802): RTK 0.01 m + 1 ppm of the way to the base CEP,
    # which is near here; as much R50 upwards is at second hand (docs/sensors.md). How much of it
    # wanders, and how slowly, are estimates: half of the variance, in 10 s.
    "rtk": GnssClass(
        AxisErrors(white=HALF_OF_RTK, bias=HALF_OF_RTK, correlation_time=10.0),
        vertical=PER_R50 / PER_CEP,
        fix=GROUND_BASED,
    ),
    # u-blox NEO-M8N: 2.5 m CEP, at second hand; its data sheet was not read. Twice that upwards, 0.2 m
    # of white noise and 100 s are estimates: errors of orbits, ionosphere and paths wander together.
    "consumer": GnssClass(
        AxisErrors(white=0.2, bias=math.sqrt((2.5 * PER_CEP) ** 2 - 0.2**2), correlation_time=100.0),
        vertical=2.0,
        fix=FIX,
    ),
}


class GnssOptions(ChipOptions):
    """Options of a GNSS receiver.

    Attributes:
        preset: Its errors: `none`, `rtk` (u-blox ZED-F9P: 1 cm), `consumer` (NEO-M8: 2.5 m). If left
            out, `--noise hardware` means a consumer's, and all else none.
    """

    errors: ClassVar[Mapping[str, AxisErrors]] = {
        name: receiver.horizontal for name, receiver in CLASSES.items()
    }
    hardware = "consumer"

    rate: Rate = 5


class GnssSensor(ChipSensor[GnssOptions]):
    """The receiver; its frame is that of its antenna."""

    def read(self) -> GnssFix:
        """Returns a fix of where the antenna is now."""
        stamp_ns, kind = self._simulation.time_ns, CLASSES[self._preset]
        x, y, z = self.pose()[0].tolist()
        east, north, up = self._triad.corrupt((0.0, 0.0, 0.0), stamp_ns)
        place = self._datum.geodetic((x + east, y + north, z + kind.vertical * up))
        known = DIAGONAL_KNOWN if any(kind.covariance) else UNKNOWN
        return GnssFix(stamp_ns, self.name, *place, kind.covariance, known, kind.fix)


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


@plain_value
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


@plain_value
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
