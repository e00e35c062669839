"""The barometer: the standard atmosphere's tables, and the errors of its chip."""

import numpy as np
import pytest

from harness.sensors.barometer import BarometerOptions, BarometerSensor, standard_pressure
from harness.sensors.geodesy import Datum
from harness.sensors.noise import HARDWARE, NoisePreset
from tests.harness.sensors.installed import installation, set_time, simulation

# ISO 2533, table 5: geopotential altitude [m], pressure [Pa].
TABLE = [
    (-500.0, 107_477.0),
    (0.0, 101_325.0),
    (1000.0, 89_874.6),
    (2000.0, 79_495.2),
    (8000.0, 35_599.8),
]


def sensor(
    preset: str = "", seed: int = 0, height: float = 0.0, noise: NoisePreset | None = None
) -> BarometerSensor:
    installed = installation(BarometerOptions(name="baro", preset=preset), seed, noise, (0.0, 0.0, 0.25))
    return BarometerSensor(simulation((0.0, 0.0, height)), Datum(0.0, 0.0, 1000.0), installed, 10)


@pytest.mark.parametrize(("altitude", "pressure"), TABLE)
def test_the_pressure_is_that_of_the_standards_table(altitude: float, pressure: float) -> None:
    assert standard_pressure(altitude) == pytest.approx(pressure, rel=1e-5)


def test_it_reads_the_pressure_of_the_datums_altitude_and_its_own_height() -> None:
    read = sensor(height=999.75).read()
    assert (read.sensor, read.variance) == ("baro", 0.0)
    assert read.fluid_pressure == pytest.approx(79_495.2, rel=1e-5)


def test_the_bmp280_has_the_errors_of_its_data_sheet() -> None:
    """BST-BMP280-DS001: +-1 hPa absolute (three deviations), 1.3 Pa RMS, 0.16 Pa resolution."""
    rng, one = np.random.default_rng(4), sensor("bmp280", 4, noise=HARDWARE)
    exact, wandered = sensor().read().fluid_pressure, rng.normal(0.0, 100 / 3, 3)[0]
    for reading in range(5):
        set_time(one, reading * 10_000.0)
        wandered += rng.normal(0.0, 100.0, 3)[0] if reading else 0.0  # 1 Pa/sqrt(s): weather
        expected = exact + wandered + rng.normal(0.0, 1.3, 3)[0]
        read = one.read()
        assert read.fluid_pressure == pytest.approx(0.16 * round(expected / 0.16))
        assert read.stamp_ns == reading * 10**13
        assert read.variance == pytest.approx((100 / 3) ** 2 + 1.3**2)
    assert sensor(noise=HARDWARE).read() == sensor("bmp280").read()
