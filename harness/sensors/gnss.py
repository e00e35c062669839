"""GNSS receiver on WGS-84, with the errors of a class of receivers."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from harness.sensors.chips import NO_ERRORS, ChipOptions, ChipSensor
from harness.sensors.corruption import AxisErrors
from harness.sensors.optional import Rate

# Standard deviation along one axis over the radius in which half of the fixes lie: of a circle (CEP), of
# a line (R50).
PER_CEP = 1.0 / math.sqrt(2.0 * math.log(2.0))
PER_R50 = 1.0 / 0.674490
UNKNOWN, DIAGONAL_KNOWN = 0, 2  # sensor_msgs/NavSatFix: COVARIANCE_TYPE_...
FIX, GROUND_BASED = 0, 2  # sensor_msgs/NavSatStatus: STATUS_FIX, STATUS_GBAS_FIX


@dataclass(frozen=True, slots=True)
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
