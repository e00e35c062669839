"""A GNSS receiver: the rover's position on the Earth, with the errors of a named class of receivers."""

import math
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

# Standard deviation along one axis over the radius in which half of the fixes lie: of a circle (CEP), of
# a line (R50).
PER_CEP = 1.0 / math.sqrt(2.0 * math.log(2.0))
PER_R50 = 1.0 / 0.674490
UNKNOWN, DIAGONAL_KNOWN = 0, 2  # sensor_msgs/NavSatFix: COVARIANCE_TYPE_...
FIX, GROUND_BASED = 0, 2  # sensor_msgs/NavSatStatus: STATUS_FIX, STATUS_GBAS_FIX
ORIGIN: Vector3 = (0.0, 0.0, 0.0)


@plain_value
class GnssFix:
    """Position of the antenna on WGS-84; names and codes are those of sensor_msgs/NavSatFix.

    Attributes:
        latitude: [deg]; likewise `longitude`.
        altitude: Above the ellipsoid [m].
        position_covariance: East, north, up by rows [m^2]; zeros if the type says unknown.
        fix: The status of NavSatStatus.
    """

    stamp_ns: int
    latitude: float
    longitude: float
    altitude: float
    position_covariance: tuple[float, ...]
    position_covariance_type: int
    fix: int


@dataclass(frozen=True, kw_only=True)
class GnssClass:
    """A class of receivers.

    Attributes:
        horizontal: Errors to the east and to the north [m].
        vertical: How many times larger they are upwards.
        fix: What it says of its fixes.
    """

    horizontal: AxisErrors
    vertical: float
    fix: int

    @property
    def covariance(self) -> tuple[float, ...]:
        """East, north, up by rows [m^2]."""
        level = self.horizontal.variance
        return (level, 0.0, 0.0, 0.0, level, 0.0, 0.0, 0.0, level * self.vertical**2)


EXACT = GnssClass(horizontal=AxisErrors(), vertical=1.0, fix=FIX)
# u-blox ZED-F9P data sheet UBX-17051259: RTK 0.01 m CEP, vertical 0.01 m R50 (near the base). How much of
# it wanders, and how slowly, are estimates: half of the variance, in 10 s.
RTK = GnssClass(
    horizontal=AxisErrors(
        white=0.01 * PER_CEP * math.sqrt(0.5),
        bias=0.01 * PER_CEP * math.sqrt(0.5),
        correlation_time=10.0,
    ),
    vertical=PER_R50 / PER_CEP,
    fix=GROUND_BASED,
)
# u-blox NEO-M8 data sheet UBX-15031086: 2.5 m CEP. Twice that upwards, 0.2 m of white noise and 100 s are
# estimates: the errors of orbits, ionosphere and paths wander together.
CONSUMER = GnssClass(
    horizontal=AxisErrors(
        white=0.2, bias=math.sqrt((2.5 * PER_CEP) ** 2 - 0.2**2), correlation_time=100.0
    ),
    vertical=2.0,
    fix=FIX,
)
CLASSES = {"none": EXACT, "rtk": RTK, "consumer": CONSUMER}


@dataclass(frozen=True, kw_only=True)
class GnssOptions:
    """Of a receiver.

    Attributes:
        noise: One of CLASSES.
    """

    noise: str = "none"

    def check(self) -> None:
        """Checks the values.

        Raises:
            UsageError: One is not valid; the message names those that are.
        """
        find_named("GNSS noise", self.noise, CLASSES)


class GnssSensor(Sensor):
    """The receiver; its antenna is at the origin of the model frame."""

    def __init__(
        self,
        simulation: "Simulation",
        datum: Datum,
        options: GnssOptions,
        rng: np.random.Generator,
        period_ticks: int,
    ) -> None:
        super().__init__(simulation, period_ticks)
        self._datum, self._class = datum, CLASSES[options.noise]
        self._errors = AxisTriad(self._class.horizontal, rng)

    def read(self) -> GnssFix:
        """Returns a fix of where the rover is now."""
        simulation, kind = self._simulation, self._class
        (x, y, z), stamp_ns = simulation.position, simulation.time_ns
        east, north, up = self._errors.corrupt(ORIGIN, stamp_ns)
        latitude, longitude, altitude = self._datum.geodetic(
            (x + east, y + north, z + kind.vertical * up)
        )
        covariance = kind.covariance
        known = DIAGONAL_KNOWN if any(covariance) else UNKNOWN
        return GnssFix(stamp_ns, latitude, longitude, altitude, covariance, known, kind.fix)
