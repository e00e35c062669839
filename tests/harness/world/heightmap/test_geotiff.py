import cmath
import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile

from harness.base.errors import UsageError
from harness.world.heightmap.raster import Raster, read_raster

PIXEL_SCALE, TIE_POINTS, TRANSFORMATION, GEO_KEYS = 33550, 33922, 34264, 34735
MODEL_TYPE, RASTER_TYPE, LINEAR_UNIT, VERTICAL_UNIT = 1024, 1025, 3076, 4099  # GeoKeys
METRES = {MODEL_TYPE: 1, LINEAR_UNIT: 9001}
VALUES = np.arange(90, dtype=np.float32).reshape(9, 10)


def read(
    folder: Path,
    *,
    scale: Sequence[float] | None = None,
    tie: Sequence[float] | None = None,
    matrix: Sequence[float] | None = None,
    keys: dict[int, int] | None = None,
    values: np.ndarray = VALUES,
) -> Raster:
    tags: list[tuple[int, str, int, Any, bool]] = [
        (tag, "d", len(numbers), tuple(numbers), True)
        for tag, numbers in ((PIXEL_SCALE, scale), (TIE_POINTS, tie), (TRANSFORMATION, matrix))
        if numbers is not None
    ]
    if keys is not None:
        flat = (1, 1, 0, len(keys), *(n for key, value in keys.items() for n in (key, 0, 1, value)))
        tags.append((GEO_KEYS, "H", len(flat), flat, True))
    tifffile.imwrite(folder / "a.tif", values, extratags=tags)
    return read_raster(folder / "a.tif")


@pytest.mark.parametrize("depth", [0.3, -0.3])  # a negative one is a size all the same, as for GDAL
@pytest.mark.parametrize("kind", [np.float32, np.uint16])
def test_pixel_scale_and_tie_point_are_read_without_geokeys(
    tmp_path: Path, depth: float, kind: type
) -> None:
    tie = (1.0, 2.0, 0.0, 500.0, 900.0, 0.0)
    raster = read(tmp_path, scale=(0.2, depth, 0.0), tie=tie, values=VALUES.astype(kind))
    assert (raster.pixel, raster.in_metres) == ((0.2, 0.3), True)
    np.testing.assert_array_equal(raster.values, VALUES)
    assert raster.notes == (
        "names no coordinate system: its pixels are taken to be metres",
        # 10 x 9 pixels; the corner of pixel 1,2 is at 500,900
        "its middle, the origin, is 500.8, 899.25 in its coordinates",
    )
    raster = read(tmp_path, scale=(2, 2, 0), tie=(0, 0, 0, 10, 50, 0), keys={**METRES, RASTER_TYPE: 2})
    assert raster.notes == (
        "its middle, the origin, is 19, 42 in its coordinates",
    )  # of a pixel's middle


@pytest.mark.parametrize("degrees", [-40.0, 0.0, 12.5])
@pytest.mark.parametrize(("mirrored", "up", "swapped"), [*itertools.product((False, True), repeat=3)])
def test_north_is_up_in_whichever_order_pixels_are_stored_and_a_turn_is_reported(
    tmp_path: Path, degrees: float, *, mirrored: bool, up: bool, swapped: bool
) -> None:
    """Pixels in any of the eight orders, placed where they belong by a matrix that may be turned."""
    stored, east, north = VALUES, 0.5 + 0j, -0.25j  # m per column and per row: complex numbers
    if mirrored:
        stored, east = stored[:, ::-1], -east
    if up:
        stored, north = stored[::-1], -north
    if swapped:
        stored, east, north = stored.T, north, east
    east, north = (step * cmath.rect(1.0, math.radians(degrees)) for step in (east, north))
    matrix = (east.real, north.real, 0, 7, east.imag, north.imag, 0, 8, *(0,) * 7, 1)
    raster = read(tmp_path, matrix=matrix, keys=METRES, values=np.ascontiguousarray(stored))
    np.testing.assert_array_equal(raster.values, VALUES)
    assert raster.pixel == pytest.approx((0.5, 0.25))
    assert any("turned so that they do" in note for note in raster.notes) is (mirrored or up or swapped)
    turns = [note for note in raster.notes if note.startswith("+x")]
    assert turns == [f"+x is {degrees:.1f} deg north of its coordinates' east"] * bool(degrees)


@pytest.mark.parametrize("pixel", [0.05, 1.0, 30.0])
@pytest.mark.parametrize(("degrees", "valid"), [(0.4, True), (-0.4, True), (0.6, False), (-0.6, False)])
def test_rows_and_columns_more_than_half_a_degree_aslant_are_refused(
    tmp_path: Path, degrees: float, pixel: float, *, valid: bool
) -> None:
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    matrix = (pixel, 2 * pixel * sin, 0, 0, 0, -2 * pixel * cos, 0, 0, *(0,) * 7, 1)
    if valid:
        assert read(tmp_path, matrix=matrix, keys=METRES).pixel == pytest.approx((pixel, 2 * pixel))
        return
    with pytest.raises(UsageError, match="not at right angles"):
        read(tmp_path, matrix=matrix, keys=METRES)


@pytest.mark.parametrize(
    "tags",
    [
        *({"tie": (0, 0, 0, 5, 5, 0)}, {"scale": (0.2,)}, {"matrix": (1, 0, 0, 0, 1, *(0,) * 11)}),
        *({"scale": (width, depth, 0.0)} for width, depth in ((0, 1), (1, 0), (math.nan, 1))),
    ],
)
def test_without_a_usable_place_the_size_is_unknown(tmp_path: Path, tags: dict[str, Any]) -> None:
    for keys in (None, METRES):
        raster = read(tmp_path, **tags, keys=keys)
        assert raster.pixel == "it does not say how large it is"
        assert raster.in_metres  # floats
        assert not read(tmp_path, **tags, keys=keys, values=VALUES.astype(np.uint8)).in_metres


@pytest.mark.parametrize(
    ("unit", "metres", "name"),
    [(9002, 0.3048, "foot"), (9003, 12 / 39.37, "US survey foot"), (9036, 1000.0, "kilometre")],
)
def test_feet_and_kilometres_become_metres(tmp_path: Path, unit: int, metres: float, name: str) -> None:
    keys = {MODEL_TYPE: 1, LINEAR_UNIT: unit}
    raster = read(tmp_path, scale=(2, 3, 0), keys=keys)
    assert raster.pixel == pytest.approx((2 * metres, 3 * metres))
    assert not raster.in_metres  # it may measure its heights in either
    assert any(name in note for note in raster.notes)
    for vertical, height_unit in ((9001, 1.0), (9002, 0.3048)):
        raster = read(tmp_path, scale=(2, 3, 0), keys={**keys, VERTICAL_UNIT: vertical})
        assert raster.in_metres
        np.testing.assert_allclose(raster.values, VALUES * height_unit)
    assert not read(tmp_path, scale=(2, 3, 0), keys={**keys, VERTICAL_UNIT: 5103}).in_metres


def test_degrees_become_metres_about_the_middle(tmp_path: Path) -> None:
    tie = (5.0, 4.5, 0.0, -70.0, 45.0, 0.0)  # the middle of 10 x 9 pixels
    raster = read(tmp_path, scale=(1e-5, 1e-5, 0), tie=tie, keys={MODEL_TYPE: 2})
    # A degree at 45 deg on WGS-84, as tables have it: 111,131.7 m of latitude, 78,846.8 m of longitude.
    np.testing.assert_allclose(raster.pixel, (0.788468, 1.111317), rtol=1e-5)  # type: ignore[arg-type]
    assert raster.in_metres
    assert raster.notes == ("its pixels are degrees: projected about its middle, 45, -70",)
    untold = read(tmp_path, scale=(1e-5, 1e-5, 0), tie=tie)  # as metres it is no ground
    assert (untold.pixel, untold.notes) == (raster.pixel, raster.notes)
    for scale, where in ((1e-2, tie), (1e-5, (0.0, 0.0, 0.0, 500.0, 45.0, 0.0))):
        assert read(tmp_path, scale=(scale, scale, 0), tie=where).pixel == pytest.approx((scale, scale))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({MODEL_TYPE: 2}, "its pixels are degrees (gdalwarp"),
        ({MODEL_TYPE: 3}, "its coordinates are geocentric (gdalwarp"),
        ({MODEL_TYPE: 1, LINEAR_UNIT: 9030}, "its unit 9030 is not known (gdalwarp"),
    ],
)
def test_degrees_and_unknown_units_are_named(tmp_path: Path, keys: dict[int, int], said: str) -> None:
    near_a_pole = (0.0, 0.0, 0.0, 10.0, 89.0, 0.0)
    values = VALUES.astype(np.uint8)
    raster = read(tmp_path, scale=(1e-5, 1e-5, 0), tie=near_a_pole, keys=keys, values=values)
    assert isinstance(raster.pixel, str)
    assert raster.pixel.startswith(said)
    assert raster.in_metres is (keys[MODEL_TYPE] == 2)  # heights above degrees are in metres
    np.testing.assert_array_equal(raster.values, VALUES)
