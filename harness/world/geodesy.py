"""Where on the Earth a world is: its datum, WGS-84, and the Earth's magnetic field there.

The world's axes are east, north and up at the datum (REP-103). `pymap3d` does the geodesy; it is
loaded by what is called, since few runs need it.
"""

import math
from dataclasses import dataclass

import numpy as np

from harness.samples import Vector3

# Dipole terms g10, g11, h11 of the World Magnetic Model 2025 (NOAA NCEI, epoch 2025.0) [T], and the
# radius that they belong to [m].
DIPOLE = np.array([-1410.8e-9, 4545.4e-9, -29351.8e-9])  # along the axes of ECEF
MAGNETIC_RADIUS = 6_371_200.0


@dataclass(frozen=True)
class Datum:
    """The world's origin.

    Attributes:
        latitude, longitude: Degrees, north and east positive.
        altitude: Above the WGS-84 ellipsoid [m].
    """

    latitude: float
    longitude: float
    altitude: float

    def geodetic(self, position: Vector3) -> Vector3:
        """Returns latitude, longitude [deg] and altitude [m] of a point of the world [m]."""
        from pymap3d import enu2geodetic  # noqa: PLC0415 - see the module

        at = enu2geodetic(*position, self.latitude, self.longitude, self.altitude)
        latitude, longitude, altitude = map(float, at)
        return latitude, longitude, altitude

    def local(self, latitude: float, longitude: float) -> tuple[float, float]:
        """Returns x and y in the world [m] of a place given in degrees, at the datum's altitude."""
        from pymap3d import geodetic2enu  # noqa: PLC0415 - see the module

        x, y, _ = geodetic2enu(
            latitude, longitude, self.altitude, self.latitude, self.longitude, self.altitude
        )
        return float(x), float(y)

    def magnetic_field(self) -> Vector3:
        """Returns the flux density of the Earth's dipole at the datum, in the world's axes [T].

        Its direction is mostly within 15 degrees and its magnitude within a fourth of the real one's.
        """
        from pymap3d import ecef2enuv, geodetic2ecef  # noqa: PLC0415 - see the module

        place = np.array(geodetic2ecef(self.latitude, self.longitude, self.altitude))
        distance = math.hypot(*place)
        up = place / distance
        field = (MAGNETIC_RADIUS / distance) ** 3 * (3.0 * sum(DIPOLE * up) * up - DIPOLE)
        east, north, upward = map(float, ecef2enuv(*field, self.latitude, self.longitude))
        return east, north, upward
