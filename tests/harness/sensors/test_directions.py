"""Directions of lidars and depth cameras: data sheets, closed forms, the intrinsic matrix, REP-103."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.choice import chosen
from harness.sensors.depth import DepthOptions
from harness.sensors.lidars import CloudLidarOptions
from harness.sensors.ranging import RangeOptions
from harness.spec.sensor import parse_choice
from tests.support.rovers import LEO

Array = NDArray[np.float64]


def options(word: str) -> RangeOptions:
    """Of a preset."""
    given = chosen(LEO, (parse_choice(word),))[-1].given
    assert isinstance(given, RangeOptions)
    return given


def angles(directions: Array) -> tuple[Array, Array]:
    """Azimuths and elevations in degrees, to a billionth."""
    assert np.linalg.norm(directions, axis=1) == pytest.approx(1.0)
    x, y, z = directions.T
    return np.degrees(np.arctan2(y, x)).round(9), np.degrees(np.arcsin(z)).round(9)


@pytest.mark.parametrize(
    ("preset", "elevations", "step", "limits"),
    [
        ("vlp16", np.arange(-15.0, 16.0, 2.0), 0.2, (0.5, 100.0)),
        ("os1_64", np.linspace(-16.6, 16.6, 64), 360 / 1024, (0.8, 120.0)),
    ],
)
def test_rings_are_those_of_the_data_sheet(
    preset: str, elevations: Array, step: float, limits: tuple[float, float]
) -> None:
    given = options(f"lidar3d={preset}")
    assert isinstance(given, CloudLidarOptions)
    azimuth, elevation = angles(given.directions())
    assert np.unique(elevation) == pytest.approx(elevations)
    assert np.diff(np.unique(azimuth)) == pytest.approx(step)
    assert len(np.unique(azimuth)) == round(360 / step)
    assert (given.rate, given.range_min, given.range_max) == (10, *limits)
    assert elevation[0] == pytest.approx(elevations[-1])  # an image's first row is its highest
    ring_of = {ring: np.unique(elevation[given.ring == ring]) for ring in range(len(elevations))}
    assert all(ring_of[ring] == pytest.approx(elevations[ring]) for ring in ring_of)


def test_a_spiral_covers_its_field_of_view_evenly() -> None:
    given = options("lidar3d=livox")
    azimuth, elevation = angles(given.directions())
    assert len(azimuth) * 10 == 200_000  # a second
    assert (elevation.min(), elevation.max()) == pytest.approx((-7.0, 52.0))
    edges = np.degrees(np.arcsin(np.linspace(math.sin(math.radians(-7)), math.sin(math.radians(52)), 6)))
    turns = np.arange(50) * (0.5 * math.sqrt(5) - 0.5) - 0.5  # a golden part further each, from behind
    assert np.exp(1j * np.radians(azimuth[:50])) == pytest.approx(np.exp(2j * np.pi * turns))
    counts, *_ = np.histogram2d(azimuth, elevation, (np.linspace(-180, 180, 9), edges))
    assert counts == pytest.approx(500, rel=0.02)  # parts of the same solid angle
    assert isinstance(given, CloudLidarOptions)
    assert not given.ring.any()


@pytest.mark.parametrize(
    ("preset", "first", "last", "step", "nearest"),
    [("rplidar_s2", -180.0, 179.8875, 0.1125, 0.05), ("planar_270", -135.0, 135.0, 0.25, 0.1)],
)
def test_planar_beams_are_those_of_the_data_sheet(
    preset: str, first: float, last: float, step: float, nearest: float
) -> None:
    given = options(f"lidar2d={preset}")
    assert (given.range_min, given.range_max) == (nearest, 30.0)
    azimuth, elevation = angles(given.directions())
    assert (azimuth[0] % 360 - 360, azimuth[-1]) == pytest.approx((first % 360 - 360, last))
    assert np.diff(azimuth[1:]) == pytest.approx(step)
    assert (elevation == 0.0).all()


@pytest.mark.parametrize(("width", "height", "fov"), [(7, 4, 1.3), (6, 5, 2.9), (1, 1, 0.1)])
def test_each_pixel_looks_where_the_intrinsic_matrix_has_it(width: int, height: int, fov: float) -> None:
    """K d = (column, row, 1), row by row from the top; the outer edges of a row are `fov` apart."""
    camera = DepthOptions(name="eye", width=width, height=height, fov=fov)
    focal = width / 2 / np.tan(fov / 2)
    matrix = np.array([[focal, 0, (width - 1) / 2], [0, focal, (height - 1) / 2], [0, 0, 1]])
    rows, columns = np.indices((height, width))
    pixels = np.column_stack([columns.ravel(), rows.ravel(), np.ones(width * height)])
    assert camera.directions() @ matrix.T == pytest.approx(pixels)
    assert camera.rays == width * height
