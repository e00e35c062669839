"""A receiver's fixes: where the antenna is, and errors as large as those of u-blox's receivers."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.geodesy import DEFAULT_DATUM, Datum
from harness.sensors.gnss import GnssFix, GnssOptions, GnssSensor
from harness.sensors.noise import GAZEBO, HARDWARE, WHITE, NoisePreset
from tests.harness.sensors.installed import installation, set_time, simulation
from tests.harness.sensors.test_geodesy import axes, ecef

DATUM = Datum(*DEFAULT_DATUM)
DESERT = (38.4064, -110.7919, 1382.0)  # Utah's Mars Desert Research Station
HALF = 1.1774  # deviations: the radius in which half of what is spread over a plane lies
HALF_OF_LINE = 0.67449


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


def errors(preset: str, count: int, every_s: float = 0.0) -> NDArray[np.float64]:
    """Of one receiver's fixes [m], or of as many receivers' first ones."""
    if not every_s:
        return np.array([in_world(sensor(preset, seed).read()) - (0, 0, 0.5) for seed in range(count)])
    one, read = sensor(preset), []
    for n in range(count):
        set_time(one, n * every_s)
        read.append(in_world(one.read()) - (0, 0, 0.5))
    return np.array(read)


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
    ("preset", "cep", "up", "status"),
    [("rtk", 0.01, 0.01 / HALF_OF_LINE, 2), ("consumer", 2.5, 4.25, 0)],
)
def test_half_of_the_receivers_are_within_the_data_sheets_circle(
    preset: str, cep: float, up: float, status: int
) -> None:
    """ZED-F9P: 0.01 m CEP, 0.01 m R50; NEO-M8: 2.5 m CEP. Binomial: 5 deviations of a half of n."""
    count = 120
    read = errors(preset, count)
    within = (np.hypot(*read[:, :2].T) < cep).mean()
    assert within == pytest.approx(0.5, abs=5 * 0.5 / np.sqrt(count))
    interval = 5 / np.sqrt(2 * count)
    assert read[:, 2].std() == pytest.approx(up, rel=interval)
    assert np.abs(read.mean(axis=0)).max() < 5 * max(cep, up) / np.sqrt(count)
    fix = sensor(preset).read()
    told = np.array(fix.position_covariance).reshape(3, 3)
    assert np.sqrt(np.diag(told)) == pytest.approx((cep / HALF, cep / HALF, up), rel=1e-3)
    assert np.count_nonzero(told) == 3
    assert (fix.position_covariance_type, fix.fix) == (2, status)


@pytest.mark.parametrize(
    ("preset", "white", "seconds"), [("rtk", 0.01 / HALF / 2**0.5, 10.0), ("consumer", 0.2, 100.0)]
)
def test_what_is_not_white_is_left_by_1_over_e_after_its_time(
    preset: str, white: float, seconds: float
) -> None:
    """Of a Gauss-Markov process r(tau) = exp(-tau / T); pairs that are T apart, 10 T between them."""
    assert GnssOptions.errors[preset].correlation_time == seconds
    total = {"rtk": 0.01, "consumer": 2.5}[preset] / HALF
    read = errors(preset, 300, seconds)[:, :2]
    correlation = (read[1:] * read[:-1]).mean() / total**2
    share = 1 - (white / total) ** 2
    assert correlation == pytest.approx(share * np.exp(-1), abs=5 / np.sqrt(read.size))
    at_once = errors(preset, 150, 1e-6)
    assert np.diff(at_once[:, :2], axis=0).std() == pytest.approx(white * 2**0.5, rel=0.25)


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
