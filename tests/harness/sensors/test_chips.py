"""GNSS, magnetometer and barometer: exact values in closed form, and the errors of their data sheets."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.stats import norm

from harness.sensors.barometer import BarometerOptions, BarometerSensor
from harness.sensors.gnss import GnssFix, GnssOptions, GnssSensor
from harness.sensors.magnetometer import MagnetometerOptions, MagnetometerSensor
from harness.sensors.noise import HARDWARE, WHITE, NoisePreset
from harness.spec.world import DEFAULT_DATUM
from harness.world.geodesy import Datum
from tests.harness.sensors.installed import installation, simulation
from tests.harness.sensors.test_geodesy import axes, ecef

DATUM = Datum(*DEFAULT_DATUM)
ATTITUDE = (0.8, 0.3, -0.4, 0.33)  # w, x, y, z
MOUNTING = Rotation.from_euler("xyz", (0.1, 0.2, 0.3))  # URDF: about fixed axes
FIELD = (2e-6, 20e-6, -46e-6)
HALF = np.sqrt(2 * np.log(2))  # deviations: the radius in which half of what lies in a plane is (CEP)
HALF_OF_LINE = norm.ppf(0.75)


def in_world(fix: GnssFix) -> NDArray[np.float64]:
    """East, north and up of a fix [m]."""
    origin = ecef(DATUM.latitude, DATUM.longitude, DATUM.altitude)
    return np.asarray(axes(DATUM) @ (ecef(fix.latitude, fix.longitude, fix.altitude) - origin))


def receiver(
    seed: int = 0, noise: NoisePreset | None = None, preset: str = ""
) -> tuple[GnssSensor, Any]:
    """On a rover at (3, -4, 1) that lies on its back: the antenna hangs half a metre below."""
    rover = simulation((3.0, -4.0, 1.0), (0.0, 1.0, 0.0, 0.0))
    options = GnssOptions(name="gnss", preset=preset)
    return GnssSensor(rover, installation(options, seed, noise, (0.0, 0.0, 0.5)), 20), rover


def test_without_noise_a_fix_is_where_the_antenna_is_and_of_unknown_covariance() -> None:
    fix = receiver()[0].read()
    assert in_world(fix) == pytest.approx((3.0, -4.0, 0.5), abs=1e-6)
    assert (fix.sensor, fix.stamp_ns, fix.fix) == ("gnss", 0, 0)
    assert (fix.position_covariance_type, set(fix.position_covariance)) == (0, {0.0})


@pytest.mark.parametrize(
    ("preset", "white", "total", "up", "seconds", "status"),
    [
        ("rtk", 0.01 / HALF / 2**0.5, 0.01 / HALF, 0.01 / HALF_OF_LINE, 10.0, 2),
        ("consumer", 0.2, 2.5 / HALF, 2 * 2.5 / HALF, 100.0, 0),
    ],
)
def test_half_of_the_fixes_are_within_the_data_sheets_circle(
    preset: str, white: float, total: float, up: float, seconds: float, status: int
) -> None:
    """ZED-F9P: 0.01 m CEP and R50; NEO-M8: 2.5 m CEP. What is not white is left by 1/e in its time."""
    rng, (sensor, rover) = np.random.default_rng(3), receiver(3, preset=preset)
    slow = np.sqrt(total**2 - white**2)
    bias, renewed = rng.normal(0.0, slow, 3), slow * np.sqrt(1 - np.exp(-2))
    for reading in range(3):
        rover.time_ns = round(reading * seconds * 1e9)
        bias = bias / np.e + rng.normal(0.0, renewed, 3) if reading else bias
        drawn = (bias + rng.normal(0.0, white, 3)) * (1, 1, up / total)
        fix = sensor.read()
        assert in_world(fix) == pytest.approx(np.array([3.0, -4.0, 0.5]) + drawn, abs=1e-6)
    given = np.array(fix.position_covariance).reshape(3, 3)
    assert given == pytest.approx(np.diag([total, total, up]) ** 2)
    assert (fix.position_covariance_type, fix.fix) == (2, status)


@pytest.mark.parametrize(
    ("noise", "preset", "expected"),
    [(None, "", 0), (WHITE, "", 0), (HARDWARE, "", 2), (HARDWARE, "none", 0)],
)
def test_the_runs_noise_counts_unless_the_sensor_has_a_preset(
    noise: NoisePreset | None, preset: str, expected: int
) -> None:
    fix = receiver(noise=noise, preset=preset)[0].read()
    assert fix.position_covariance_type == expected
    assert not expected or fix == receiver(preset="consumer")[0].read()


def compass(seed: int = 0, noise: NoisePreset | None = None, **options: Any) -> tuple[Any, Any]:  # noqa: ANN401
    rover, given = simulation(quaternion=ATTITUDE), MagnetometerOptions(name="compass", **options)
    installed = installation(given, seed, noise, axes=MOUNTING.as_matrix())
    return MagnetometerSensor(rover, installed, 5), rover


@pytest.mark.parametrize(("field", "given"), [(FIELD, FIELD), (DATUM.magnetic_field(2026.0), ())])
def test_a_magnetometer_sees_the_field_of_the_datum_in_its_own_axes(
    field: tuple[float, ...], given: tuple[float, ...]
) -> None:
    read = compass(field=given)[0].read()
    rover = Rotation.from_quat(ATTITUDE, scalar_first=True)
    assert read.magnetic_field == pytest.approx((rover * MOUNTING).inv().apply(field), rel=1e-9)
    assert (read.sensor, set(read.magnetic_field_covariance)) == ("compass", {0.0})


def barometer(
    preset: str = "", seed: int = 0, height: float = 0.0, noise: NoisePreset | None = None
) -> tuple[BarometerSensor, Any]:
    options, rover = BarometerOptions(name="baro", preset=preset), simulation((0.0, 0.0, height))
    installed = installation(options, seed, noise, (0.0, 0.0, 0.25), datum=Datum(0.0, 0.0, 1000.0))
    return BarometerSensor(rover, installed, 10), rover


@pytest.mark.parametrize(
    ("altitude", "pressure"),
    [(-500, 107_477.0), (0, 101_325.0), (1000, 89_874.6), (2000, 79_495.2), (8000, 35_599.8)],
)
def test_a_barometer_reads_the_pressure_of_table_5_of_iso_2533(altitude: float, pressure: float) -> None:
    read = barometer(height=altitude - 1000.25)[0].read()  # 0.25 m below the sensor, datum at 1000 m
    assert (read.sensor, read.variance) == ("baro", 0.0)
    assert read.fluid_pressure == pytest.approx(pressure, rel=1e-5)
