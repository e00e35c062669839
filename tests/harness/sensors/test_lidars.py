"""Directions of optional lidars against the products of their names, and what cannot be a lidar."""

import math
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.robots import find_rover
from harness.sensors.choice import chosen
from harness.sensors.lidars import CloudLidarOptions, PlanarLidarOptions
from harness.sensors.ranging import RangeOptions

Array = NDArray[np.float64]
CLOUD, PLANAR = CloudLidarOptions, PlanarLidarOptions


def options(word: str) -> RangeOptions:
    """Of a preset."""
    given = chosen(find_rover("leo"), (word,))[-1].given
    assert isinstance(given, RangeOptions)
    return given


def angles(directions: Array) -> tuple[Array, Array]:
    """Azimuths and elevations in degrees, to a billionth."""
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    x, y, z = directions.T
    return np.degrees(np.arctan2(y, x)).round(9), np.degrees(np.arcsin(z)).round(9)


@pytest.mark.parametrize(
    ("preset", "elevations", "step", "rate", "limits"),
    [
        ("vlp16", np.arange(-15.0, 16.0, 2.0), 0.2, 10, (0.5, 100.0)),
        ("os1_64", np.linspace(-16.6, 16.6, 64), 360 / 1024, 10, (0.8, 120.0)),
    ],
)
def test_rings_are_those_of_the_data_sheet(
    preset: str, elevations: Array, step: float, rate: int, limits: tuple[float, float]
) -> None:
    given = options(f"lidar3d={preset}")
    assert isinstance(given, CloudLidarOptions)
    azimuth, elevation = angles(given.directions())
    assert np.unique(elevation) == pytest.approx(elevations)
    assert np.diff(np.unique(azimuth)) == pytest.approx(step)
    assert len(np.unique(azimuth)) == round(360 / step)
    assert (given.rate, given.range_min, given.range_max) == (rate, *limits)
    assert elevation[0] == pytest.approx(elevations[-1])  # an image's first row is its highest
    ring_of = {ring: np.unique(elevation[given.ring == ring]) for ring in range(len(elevations))}
    assert all(ring_of[ring] == pytest.approx(elevations[ring]) for ring in ring_of)


def test_a_spiral_covers_its_field_of_view_evenly() -> None:
    azimuth, elevation = angles(options("lidar3d=livox").directions())
    assert len(azimuth) * 10 == 200_000  # a second
    assert (elevation.min(), elevation.max()) == pytest.approx((-7.0, 52.0))
    edges = np.degrees(np.arcsin(np.linspace(math.sin(math.radians(-7)), math.sin(math.radians(52)), 6)))
    turns = np.arange(50) * 2 / (1 + math.sqrt(5)) - 0.5  # a golden part further each, from behind
    assert np.exp(1j * np.radians(azimuth[:50])) == pytest.approx(np.exp(2j * np.pi * turns))
    counts, *_ = np.histogram2d(azimuth, elevation, (np.linspace(-180, 180, 9), edges))
    assert counts == pytest.approx(500, rel=0.02)  # parts of the same solid angle


@pytest.mark.parametrize(
    ("preset", "first", "last", "step"),
    [("rplidar_s2", -180.0, 179.8875, 0.1125), ("planar_270", -135.0, 135.0, 0.25)],
)
def test_planar_beams_are_those_of_the_data_sheet(
    preset: str, first: float, last: float, step: float
) -> None:
    azimuth, elevation = angles(options(f"lidar2d={preset}").directions())
    assert (azimuth[0] % 360 - 360, azimuth[-1]) == pytest.approx((first % 360 - 360, last))
    assert np.diff(azimuth[1:]) == pytest.approx(step)
    assert (elevation == 0.0).all()


@pytest.mark.parametrize(("span", "step"), [(2 * np.pi, 2 * np.pi / 5), (6.0, 1.5), (3.5, 0.875)])
def test_all_around_the_last_column_would_be_the_first_and_otherwise_both_ends_are_there(
    span: float, step: float
) -> None:
    given = CloudLidarOptions(name="x", rings=1, columns=5, angle_min=-span / 2, angle_max=span / 2)
    azimuth, _ = angles(given.directions())
    expected = np.arange(5) * step - span / 2
    assert np.exp(1j * np.radians(azimuth)) == pytest.approx(np.exp(1j * expected))


def test_elevations_of_ones_own_and_part_of_a_circle() -> None:
    given = CloudLidarOptions(name="x", elevations=(-0.2, 0.1), columns=3, angle_min=-0.5, angle_max=0.5)
    azimuth, elevation = angles(given.directions())
    assert np.radians(azimuth) == pytest.approx([-0.5, 0.0, 0.5] * 2)
    assert np.radians(elevation) == pytest.approx([0.1] * 3 + [-0.2] * 3)
    assert given.ring.tolist() == [1, 1, 1, 0, 0, 0]
    spiral = CloudLidarOptions(name="x", rings=2, columns=3, pattern="spiral")
    assert spiral.ring.dtype == np.uint16
    assert spiral.ring.tolist() == [0] * 6


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        (CLOUD, {"rings": 1000, "columns": 10_000}, r"10,000,000 rays a reading .* 1 to 500,000"),
        (CLOUD, {"angle_min": 1.0, "angle_max": 1.0}, r"a field of view from 1 to 1 rad is not"),
        (CLOUD, {"angle_min": -3.2}, r"a field of view from -3\.2 to 3\.14159 rad"),
        (CLOUD, {"angle_max": 4.0}, r"from -3\.14159 to 3\.14159"),
        (CLOUD, {"lowest": 0.3, "highest": 0.1}, r"elevations from 0\.3 to 0\.1 rad is not valid"),
        (CLOUD, {"highest": 1.6}, r"elevations from .* to 1\.6 rad .* to 1\.5708$"),
        (CLOUD, {"elevations": (-1.6, 0.1)}, r"elevations from -1\.6 to 0\.1 rad"),
        (CLOUD, {"elevations": (0.1, 0.3, 0.2)}, r"from the lowest to the highest"),
        (CLOUD, {"pattern": "zigzag"}, r"pattern 'zigzag' is not valid; give rings or spiral"),
        (CLOUD, {"misses": "zero"}, r"misses 'zero' is not valid; give left_out or nan"),
        (CLOUD, {"pattern": "spiral", "organised": True}, r"a spiral has no rings"),
        (CLOUD, {"pattern": "spiral", "elevations": (0.1,)}, r"a spiral has no rings"),
        (PLANAR, {"angle_max": 3.2}, r"a field of view from -3\.14159 to 3\.2 rad"),
        (PLANAR, {"angle_min": 0.0, "angle_max": 0.0}, r"field of view from 0 to 0 rad"),
        (PLANAR, {"beams": 1}, r"1 beams are not valid; give 2 or more"),
        (PLANAR, {"beams": 10_000_000}, r"10,000,000 rays"),
    ],
)
def test_what_cannot_be_is_told(kind: Any, values: dict[str, Any], message: str) -> None:  # noqa: ANN401
    with pytest.raises(UsageError, match=message):
        kind(name="x", **values).check()


def test_a_single_ring_has_no_span_of_elevations_and_two_beams_are_a_lidar() -> None:
    PLANAR(name="two", beams=2).check()
    CloudLidarOptions(name="one", rings=1, lowest=0.1, highest=0.1).check()
    CloudLidarOptions(name="one", elevations=(0.1,)).check()
