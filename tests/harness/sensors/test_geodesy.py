"""The datum against closed forms of WGS-84 and of a dipole, written here from their definitions."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from harness.world.geodesy import Datum

A, F = 6_378_137.0, 1 / 298.257223563  # WGS-84
DATUMS = st.builds(Datum, st.floats(-85, 85), st.floats(-180, 180), st.floats(-400, 8000))


def ecef(latitude: float, longitude: float, altitude: float) -> NDArray[np.float64]:
    """Earth-centred position [m] of a geodetic one [deg, deg, m]."""
    phi, lam = np.radians((latitude, longitude))
    e2 = F * (2 - F)
    n = A / math.sqrt(1 - e2 * math.sin(phi) ** 2)
    level = (n + altitude) * math.cos(phi)
    up = (n * (1 - e2) + altitude) * math.sin(phi)
    return np.array([level * math.cos(lam), level * math.sin(lam), up])


def axes(datum: Datum) -> NDArray[np.float64]:
    """East, north and up of a datum in ECEF, by rows."""
    phi, lam = np.radians((datum.latitude, datum.longitude))
    return np.array(
        [
            [-math.sin(lam), math.cos(lam), 0.0],
            [-math.sin(phi) * math.cos(lam), -math.sin(phi) * math.sin(lam), math.cos(phi)],
            [math.cos(phi) * math.cos(lam), math.cos(phi) * math.sin(lam), math.sin(phi)],
        ]
    )


@settings(max_examples=25)
@given(DATUMS, *[st.floats(-500, 500)] * 3)
def test_a_point_of_the_world_is_where_the_ellipsoid_has_it(
    datum: Datum, x: float, y: float, z: float
) -> None:
    origin = ecef(datum.latitude, datum.longitude, datum.altitude)
    back = axes(datum) @ (ecef(*datum.geodetic((x, y, z))) - origin)
    assert back == pytest.approx((x, y, z), abs=1e-6)


@settings(max_examples=25)
@given(DATUMS)
def test_the_field_is_that_of_a_dipole_through_the_middle_of_the_earth(datum: Datum) -> None:
    """In the dipole's own coordinates: B0 (a/r)^3 (2 cos along r, sin along the magnetic colatitude)."""
    g10, g11, h11 = -29351.8e-9, -1410.8e-9, 4545.4e-9  # WMM2025
    strength = math.hypot(g10, g11, h11)
    south = np.array([g11, h11, g10]) / strength  # what g points along is the pole in the south
    place = ecef(datum.latitude, datum.longitude, datum.altitude)
    radius = float(np.linalg.norm(place))
    cosine = float(place @ south) / radius
    size = strength * (6_371_200.0 / radius) ** 3 * math.sqrt(1 + 3 * cosine**2)
    field = np.array(datum.magnetic_field())
    assert np.linalg.norm(field) == pytest.approx(size, rel=1e-9)
    outward = (axes(datum) @ place / radius) @ field
    assert outward == pytest.approx(2 * strength * (6_371_200.0 / radius) ** 3 * cosine, abs=1e-15)
