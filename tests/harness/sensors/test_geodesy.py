"""The datum against closed forms of WGS-84, and the World Magnetic Model as its authors compute it."""

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


@pytest.mark.parametrize(
    ("year", "altitude", "latitude", "longitude", "north", "east", "down"),
    [  # wmm-calculator 1.4.4, of the model's authors [nT]; six are points of the model's report
        (2025.0, 0.0, 80.0, 0.0, 6521.60, 145.89, 54791.51),
        (2025.0, 0.0, 0.0, 120.0, 39677.76, -109.61, -10580.17),
        (2025.0, 0.0, -80.0, 240.0, 6117.55, 15751.91, -52022.52),
        (2025.0, 100e3, 80.0, 0.0, 6216.02, 92.44, 52598.83),
        (2027.5, 0.0, 80.0, 0.0, 6500.83, 294.53, 54869.36),
        (2027.5, 100e3, -80.0, 240.0, 5983.98, 14760.14, -49317.67),
        (2026.0, 1382.0, 38.4064, -110.7919, 21525.05, 3790.08, 44545.42),
    ],
)
def test_the_field_is_that_of_the_world_magnetic_model(
    year: float,
    altitude: float,
    latitude: float,
    longitude: float,
    north: float,
    east: float,
    down: float,
) -> None:
    field = Datum(latitude, longitude, altitude).magnetic_field(year)
    assert field == pytest.approx((east * 1e-9, north * 1e-9, -down * 1e-9), abs=1e-11)
