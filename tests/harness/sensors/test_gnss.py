"""A receiver's fixes: where the antenna is, and errors as large as those of u-blox's receivers."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import norm

from harness.sensors.geodesy import DEFAULT_DATUM, Datum
from harness.sensors.gnss import GnssFix, GnssOptions, GnssSensor
from harness.sensors.noise import GAZEBO, HARDWARE, WHITE, NoisePreset
from tests.harness.sensors.installed import installation, set_time, simulation
from tests.harness.sensors.test_geodesy import axes, ecef

DATUM = Datum(*DEFAULT_DATUM)
DESERT = (38.4064, -110.7919, 1382.0)  # Utah's Mars Desert Research Station
HALF = np.sqrt(2 * np.log(2))  # deviations: the radius in which half of what lies in a plane is (CEP)
HALF_OF_LINE = norm.ppf(0.75)


def sensor(
    preset: str = "", seed: int = 0, noise: NoisePreset | None = None, **place: tuple[float, ...]
) -> GnssSensor:
    options = GnssOptions(name="gnss", preset=preset)
    return GnssSensor(
        simulation(**place), DATUM, installation(options, seed, noise, (0.0, 0.0, 0.5)), 20
    )


def in_world(fix: GnssFix) -> NDArray[np.float64]:
    """East, north and up of a fix [m]."""
    origin = ecef(DATUM.latitude, DATUM.longitude, DATUM.altitude)
    return np.asarray(axes(DATUM) @ (ecef(fix.latitude, fix.longitude, fix.altitude) - origin))


def test_the_world_lies_at_a_station_of_the_desert_unless_it_is_told_otherwise() -> None:
    fix = sensor(position=(0.0, 0.0, -0.5)).read()
    assert (fix.latitude, fix.longitude, fix.altitude) == pytest.approx(DESERT, abs=1e-6)


def test_without_noise_a_fix_is_where_the_antenna_is_and_of_unknown_covariance() -> None:
    turned_over = (0.0, 1.0, 0.0, 0.0)  # upside down: the antenna hangs below
    fix = sensor(position=(3.0, -4.0, 1.0), quaternion=turned_over).read()
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
    rng, one = np.random.default_rng(3), sensor(preset, 3, position=(3.0, -4.0, 1.0))
    antenna = np.array([3.0, -4.0, 1.5])
    slow = np.sqrt(total**2 - white**2)
    bias, renewed = rng.normal(0.0, slow, 3), slow * np.sqrt(1 - np.exp(-2))
    for reading in range(3):
        set_time(one, reading * seconds)
        bias = bias / np.e + rng.normal(0.0, renewed, 3) if reading else bias
        drawn = (bias + rng.normal(0.0, white, 3)) * (1, 1, up / total)
        fix = one.read()
        assert in_world(fix) == pytest.approx(antenna + drawn, abs=1e-6)
    told = np.array(fix.position_covariance).reshape(3, 3)
    assert np.sqrt(np.diag(told)) == pytest.approx((total, total, up))
    assert np.count_nonzero(told) == 3
    assert (fix.position_covariance_type, fix.fix) == (2, status)


@pytest.mark.parametrize(
    ("noise", "preset", "expected"),
    [(None, "", 0), (WHITE, "", 0), (GAZEBO, "", 0), (HARDWARE, "", 2), (HARDWARE, "none", 0)],
)
def test_the_runs_noise_counts_unless_the_receiver_has_a_preset(
    noise: NoisePreset | None, preset: str, expected: int
) -> None:
    fix = sensor(preset, noise=noise).read()
    assert fix.position_covariance_type == expected
    if expected:
        assert fix == sensor("consumer").read()
