"""Where on the Earth a world is: its datum, WGS-84, and the Earth's magnetic field there.

The world's axes are east, north and up at the datum (REP-103). `pymap3d` does the geodesy, `pygeomag`
the World Magnetic Model; they are loaded by what is called, since few runs need them.
"""

from dataclasses import dataclass

from harness.samples import Vector3

MAGNETIC_YEARS = 2025.0, 2030.0  # for which the World Magnetic Model of 2025 (NOAA NCEI) is made
NANO = 1e-9


@dataclass(frozen=True)
class Datum:
    """The world's origin."""

    latitude: float  # [deg], north positive
    longitude: float  # [deg], east positive
    altitude: float  # above the WGS-84 ellipsoid [m]

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

    def magnetic_field(self, year: float) -> Vector3:
        """Returns the flux density of the Earth at the datum, in the world's axes [T].

        It is that of the core, to degree 12 of spherical harmonics, in a decimal year within
        MAGNETIC_YEARS; crust, iron and the sun change it by some 100 nT.
        """
        from pygeomag import GeoMag  # noqa: PLC0415 - see the module

        model = GeoMag(coefficients_file="wmm/WMM_2025.COF")
        at = model.calculate(self.latitude, self.longitude, self.altitude / 1000.0, year)
        return at.y * NANO, at.x * NANO, -at.z * NANO
