"""The magnetometer: the Earth's field in its axes, and the errors of its chip."""

from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.sensors.geodesy import DEFAULT_DATUM, Datum
from harness.sensors.magnetometer import MagnetometerOptions, MagnetometerSensor
from harness.sensors.noise import HARDWARE
from tests.harness.sensors.installed import installation, set_time, simulation

DATUM = Datum(*DEFAULT_DATUM)
FIELD = (2e-6, 20e-6, -46e-6)


def sensor(
    seed: int = 0,
    quaternion: tuple[float, ...] = (1, 0, 0, 0),
    **options: Any,  # noqa: ANN401 - of several types
) -> MagnetometerSensor:
    told = MagnetometerOptions(name="compass", **options)
    axes = Rotation.from_euler("xyz", (0.1, 0.2, 0.3)).as_matrix()
    return MagnetometerSensor(
        simulation(quaternion=quaternion), DATUM, installation(told, seed, axes=axes), 5
    )


def test_it_sees_the_field_of_the_datum_in_its_own_axes() -> None:
    attitude = (0.8, 0.3, -0.4, 0.33)
    mounting = Rotation.from_euler("xyz", (0.1, 0.2, 0.3))  # URDF: about fixed axes
    rover = Rotation.from_quat((0.3, -0.4, 0.33, 0.8))
    cases: tuple[tuple[Any, dict[str, Any]], ...]
    cases = ((FIELD, {"field": FIELD}), (DATUM.magnetic_field(), {}))
    for field, told in cases:
        read = sensor(quaternion=attitude, **told).read()
        assert read.magnetic_field == pytest.approx((rover * mounting).inv().apply(field), rel=1e-9)
        assert (read.sensor, set(read.magnetic_field_covariance)) == ("compass", {0.0})


def test_the_bmm150_has_the_errors_of_its_data_sheet() -> None:
    """BST-BMM150-DS001: 0.3 uT RMS, 0.3 uT resolution, 2 uT left of the offset, +-1300 uT."""
    still: dict[str, Any] = {"field": FIELD, "preset": "bmm150"}
    rng, one = np.random.default_rng(4), sensor(4, **still)
    exact = np.array(sensor(field=FIELD).read().magnetic_field) + rng.normal(0.0, 2e-6, 3)
    for seconds in (0.0, 1e6):  # what is left of the offset stays
        set_time(one, seconds)
        counts = np.round((exact + rng.normal(0.0, 0.3e-6, 3)) / 0.3e-6)
        read = one.read()
        assert read.stamp_ns == seconds * 1e9
        assert read.magnetic_field == pytest.approx(0.3e-6 * counts)
    told = np.array(one.read().magnetic_field_covariance).reshape(3, 3)
    np.testing.assert_allclose(told, (0.3**2 + 2.0**2) * 1e-12 * np.eye(3), rtol=1e-9, atol=0)
    assert MagnetometerOptions.errors["bmm150"].limit == 1300e-6


def test_noise_hardware_means_that_chip() -> None:
    options = MagnetometerOptions(name="compass")
    read = MagnetometerSensor(simulation(), DATUM, installation(options, noise=HARDWARE), 5).read()
    assert read.magnetic_field_covariance[0] == pytest.approx(4.09e-12)


@pytest.mark.parametrize(
    "field", [(1e-6,), (1e-6, 2e-6, 3.0), (-3.0, 0.0, 0.0), (0.0, float("nan"), 0.0)]
)
def test_a_field_in_other_units_is_refused_and_a_name_that_is_none(field: tuple[float, ...]) -> None:
    with pytest.raises(UsageError, match=r"name '2' is not valid"):
        MagnetometerOptions(name="2").check()
    with pytest.raises(UsageError, match=r"give east, north and up in tesla, each within 0\.001, e"):
        MagnetometerOptions(name="compass", field=field).check()


@pytest.mark.parametrize("field", [(), (1e-3, -1e-3, 0.0)])
def test_the_earths_field_or_one_of_up_to_a_millitesla_is_valid(field: tuple[float, ...]) -> None:
    MagnetometerOptions(name="compass", field=field).check()
