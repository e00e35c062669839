import cmath
import itertools
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from pymap3d.vincenty import vdist

from harness.base.errors import UsageError
from harness.world.heightmap.raster import Raster, read_raster

PIXEL_SCALE, TIE_POINTS, TRANSFORMATION, GEO_KEYS = 33550, 33922, 34264, 34735
GEO_DOUBLES, GEO_TEXTS, GDAL_METADATA = 34736, 34737, 42112
PROJECTED, CITATION, VERTICAL, MAJOR_AXIS = 3072, 1026, 4096, 2057  # GeoKeys
MODEL_TYPE, RASTER_TYPE, LINEAR_UNIT, VERTICAL_UNIT = 1024, 1025, 3076, 4099  # GeoKeys
FOOT, US_FOOT = 0.3048, 12 / 39.37
METRES: Mapping[int, Any] = {MODEL_TYPE: 1, LINEAR_UNIT: 9001}
VALUES = np.arange(90, dtype=np.float32).reshape(9, 10)


def read(
    folder: Path,
    *,
    scale: Sequence[float] | None = None,
    tie: Sequence[float] | None = None,
    matrix: Sequence[float] | None = None,
    keys: Mapping[int, Any] | None = None,
    values: np.ndarray = VALUES,
    metadata: str = "",
) -> Raster:
    tags: list[tuple[int, str, int, Any, bool]] = [
        (tag, "d", len(numbers), tuple(numbers), True)
        for tag, numbers in ((PIXEL_SCALE, scale), (TIE_POINTS, tie), (TRANSFORMATION, matrix))
        if numbers is not None
    ]
    if keys is not None:
        flat, texts, doubles = [1, 1, 0, len(keys)], "", list[float]()
        for key, value in keys.items():
            if isinstance(value, int):
                flat += [key, 0, 1, value]
            elif isinstance(value, float):
                flat += [key, GEO_DOUBLES, 1, len(doubles)]
                doubles.append(value)
            else:
                flat += [key, GEO_TEXTS, len(value) + 1, len(texts)]
                texts += f"{value}|"
        tags.append((GEO_KEYS, "H", len(flat), tuple(flat), True))
        tags += [(GEO_TEXTS, "s", 0, texts, True)] * bool(texts)
        tags += [(GEO_DOUBLES, "d", len(doubles), tuple(doubles), True)] * bool(doubles)
    if metadata:
        item = f'<Item name="UNITTYPE" sample="0" role="unittype">{metadata}</Item>'
        tags.append((GDAL_METADATA, "s", 0, f"<GDALMetadata>{item}</GDALMetadata>", True))
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
    (tmp_path / "a.tfw").write_text(f"0.2\n0\n0\n-{abs(depth)}\n499.9\n900.45\n")
    beside = read(tmp_path, values=VALUES.astype(kind))
    assert (beside.pixel, beside.in_metres, beside.notes) == (raster.pixel, True, raster.notes)
    (tmp_path / "a.tfw").write_bytes(b"0.2 0 0 -0.3 \xff")
    with pytest.raises(UsageError, match=r"a\.tfw beside it is no world file"):
        read(tmp_path, values=VALUES.astype(kind))
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


@pytest.mark.parametrize(
    ("name", "metres"),
    [("NAD83 / New York Long Island (ftUS)", US_FOOT), ("X (ft)", FOOT), ("WGS 84 / UTM zone 18N", 1.0)],
)
@pytest.mark.parametrize(
    ("heights", "height"), [(6360, US_FOOT), (8228, FOOT), (5754, 0.3048007491), (5703, 1.0)]
)
def test_a_crs_that_is_named_alone_has_the_units_of_its_name_and_number(
    tmp_path: Path, name: str, metres: float, heights: int, height: float
) -> None:
    """As one with heights that has no number: no unit, but the CRSs' names."""
    keys = {MODEL_TYPE: 1, CITATION: f"{name} + NAVD88 height (ftUS)", VERTICAL: heights}
    raster = read(tmp_path, scale=(2, 3, 0), keys=keys)
    assert raster.pixel == pytest.approx((2 * metres, 3 * metres))
    np.testing.assert_allclose(raster.values, VALUES * height)


@pytest.mark.parametrize("depths", [5715, 5831, 6358, 10375])
def test_depths_are_no_heights(tmp_path: Path, depths: int) -> None:
    with pytest.raises(UsageError, match="depths"):
        read(tmp_path, scale=(2, 3, 0), keys={**METRES, VERTICAL: depths})


@pytest.mark.parametrize(
    ("number", "metres"),
    [
        *((number, US_FOOT) for number in (26729, 26803, 2964, 32058, 2263, 2287, 3089, 6539, 8528)),
        *((number, FOOT) for number in (3080, 2256, 2266, 6557, 6823)),
        *((number, 1.0) for number in (32618, 26985, 3090, 6538, 6558, 6824, 29371)),
    ],
)
@pytest.mark.parametrize("named", [{CITATION: "NAD27 / X + NAVD88 height"}, {}])
def test_a_crs_that_is_named_by_its_number_has_the_unit_that_epsg_gives_it(
    tmp_path: Path, number: int, metres: float, named: dict[int, Any]
) -> None:
    """The units are those that pyproj has of these numbers; GeoTIFF 1.1 has no names beside them."""
    keys = {MODEL_TYPE: 1, **named, VERTICAL: 5703, PROJECTED: number}
    raster = read(tmp_path, scale=(2, 3, 0), keys=keys)
    assert raster.pixel == pytest.approx((2 * metres, 3 * metres))


@pytest.mark.parametrize("keys", [METRES, {MODEL_TYPE: 2}, {MODEL_TYPE: 1, LINEAR_UNIT: 9002}, None])
@pytest.mark.parametrize(
    ("unit", "metres"), [("ft", FOOT), ("US survey foot", US_FOOT), ("cm", 0.01), ("Metre", 1.0)]
)
@pytest.mark.parametrize("kind", [np.float32, np.int16])
def test_a_bands_unit_is_that_of_its_heights(
    tmp_path: Path, keys: Mapping[int, Any] | None, unit: str, metres: float, kind: type
) -> None:
    values: np.ndarray = VALUES.astype(kind)
    raster = read(tmp_path, scale=(1, 1, 0), keys=keys, metadata=unit, values=values)
    assert raster.in_metres
    np.testing.assert_allclose(raster.values, VALUES * metres)
    assert not read(tmp_path, scale=(1, 1, 0), keys=keys, metadata="smoots", values=values).in_metres


@pytest.mark.parametrize(("latitude", "longitude"), [(61.5, -149.9), (0.0, 0.0), (-45.0, 170.0)])
def test_web_mercators_pixels_are_as_long_as_on_the_ground(
    tmp_path: Path, latitude: float, longitude: float
) -> None:
    radius, step = 6378137.0, 2e-6  # [m], [deg]: of a pixel, measured on the ellipsoid by Vincenty
    x, y = math.radians(longitude) * radius, math.asinh(math.tan(math.radians(latitude))) * radius
    tie = (5.0, 4.5, 0.0, x, y, 0.0)
    east = math.radians(step) * radius
    raster = read(tmp_path, scale=(east, east, 0), tie=tie, keys={**METRES, PROJECTED: 3857})
    north = step * math.cos(math.radians(latitude))
    along = vdist(latitude, longitude - 500 * step, latitude, longitude + 500 * step)[0]
    up = vdist(latitude - 500 * north, longitude, latitude + 500 * north, longitude)[0]
    np.testing.assert_allclose(raster.pixel, (along / 1e3, up / 1e3), rtol=1e-5)  # type: ignore[arg-type]


TRANSFORM, PARALLEL, CENTRE_LATITUDE, NORTHING, ORIGIN_SCALE = 3075, 3078, 3089, 3083, 3092  # GeoKeys


@pytest.mark.parametrize(
    ("keys", "y", "pixel"),  # of 1 m, as long on the ground as PROJ 9.5 (its get_factors) says
    [
        ({TRANSFORM: 17, MAJOR_AXIS: 3396190.0}, 1090654.4344, (0.948876, 1.0)),  # Jezero crater
        (
            {
                TRANSFORM: 17,
                PARALLEL: 15.0,
                CENTRE_LATITUDE: 5.0,
                NORTHING: 500.0,
                MAJOR_AXIS: 3396190.0,
            },
            794780.9468,
            (0.982349, 1.0),
        ),
        ({PROJECTED: 3395}, 6413524.5942, (0.644054, 0.644054)),
        ({PROJECTED: 3832}, 6413524.5942, (0.644054, 0.644054)),
        ({PROJECTED: 5641}, 6.5e6, (0.865919, 0.865919)),
        ({PROJECTED: 4087}, 6679169.4476, (0.501260, 1.000834)),
        ({TRANSFORM: 7, PARALLEL: 41.0}, 4847336.9319, (0.852149, 0.852149)),
        ({TRANSFORM: 7, ORIGIN_SCALE: 0.997, NORTHING: 900000.0}, 126349.4311, (0.995582, 0.995582)),
    ],
)
def test_cylindrical_maps_have_pixels_as_long_as_on_the_ground(
    tmp_path: Path, keys: Mapping[int, Any], y: float, pixel: tuple[float, float]
) -> None:
    raster = read(tmp_path, scale=(1, 1, 0), tie=(5, 4.5, 0, 9e5, y, 0), keys={**METRES, **keys})
    np.testing.assert_allclose(raster.pixel, pixel, rtol=2e-6)  # type: ignore[arg-type]
    near_the_true_one = read(tmp_path, scale=(1, 1, 0), keys={**METRES, TRANSFORM: 17})
    assert near_the_true_one.pixel == (1.0, 1.0)


def test_columns_may_run_west(tmp_path: Path) -> None:
    raster = read(tmp_path, scale=(-0.2, 0.3, 0.0), tie=(0.0,) * 6, keys=METRES)
    np.testing.assert_array_equal(raster.values, VALUES[:, ::-1])


def test_what_gdal_wrote_beside_a_file_counts(tmp_path: Path) -> None:
    said = '<NoDataValue le_hex_equiv="00">5</NoDataValue><Offset>2</Offset><Scale>0.5</Scale>'
    said += "<UnitType>ft</UnitType>"
    band = f'<PAMDataset><PAMRasterBand band="1">{said}</PAMRasterBand></PAMDataset>'
    (tmp_path / "a.tif.aux.xml").write_text(band, encoding="utf-8")
    tifffile.imwrite(tmp_path / "a.tif.msk", 255 * (VALUES != 7).astype(np.uint8))
    mended = np.where((VALUES == 5) | (VALUES == 7), np.nan, (0.5 * VALUES + 2.0) * FOOT)
    np.testing.assert_allclose(read(tmp_path, scale=(1, 1, 0), keys=METRES).values, mended)


def test_what_a_files_own_mask_hides_is_missing(tmp_path: Path) -> None:
    mask = np.ones(VALUES.shape, np.bool_)
    mask[:, 4] = False
    with tifffile.TiffWriter(tmp_path / "a.tif") as file:
        file.write(VALUES)
        file.write(mask, subfiletype=4, photometric="mask")
    np.testing.assert_array_equal(np.isnan(read_raster(tmp_path / "a.tif").values), ~mask)


def test_degrees_of_another_body_are_as_long_as_its_radius_says(tmp_path: Path) -> None:
    keys = {MODEL_TYPE: 2, MAJOR_AXIS: 1737400.0}  # a sphere: the Moon
    tie = (5.0, 4.5, 0.0, 20.0, 60.0, 0.0)
    raster = read(tmp_path, scale=(1e-5, 1e-5, 0), tie=tie, keys=keys)
    arc = math.radians(1e-5) * 1737400.0
    np.testing.assert_allclose(raster.pixel, (arc / 2, arc), rtol=1e-9)  # type: ignore[arg-type]


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
    ("keys", "middle", "metres"),  # of 10 m of the map, by pyproj
    [
        ({PROJECTED: 3413}, (400.0, -3300320.0), 9.629512),
        ({PROJECTED: 3996}, (400.0, -3300320.0), 9.517770),
        ({PROJECTED: 5041}, (2000400.0, 700000.0), 9.956391),
        ({PROJECTED: 3031}, (400.0, 999680.0), 10.214080),
        ({TRANSFORM: 15, 3081: 75.0}, (1000400.0, 999680.0), 10.046313),
    ],
)
def test_polar_maps_become_as_long_as_the_ground(
    tmp_path: Path, keys: Mapping[int, Any], middle: tuple[float, float], metres: float
) -> None:
    tie = (5.0, 4.5, 0.0, *middle, 0.0)
    raster = read(tmp_path, scale=(10.0, 10.0, 0.0), tie=tie, keys={MODEL_TYPE: 1, **keys})
    assert raster.pixel == pytest.approx((metres, metres), rel=2e-3)  # of a sphere


@pytest.mark.parametrize("east", [0.0, 3e4, 6e6])  # [m] of the meridian that is straight
@pytest.mark.parametrize(
    "keys",
    [
        *({TRANSFORM: 24, MAJOR_AXIS: 6371007.181}, {TRANSFORM: 28}),
        *({PROJECTED: number} for number in (6933, 8857, 3571)),
        {3073: 'ESRI PE String = PROJCS["a",PROJECTION["Mollweide"]'},
    ],
)
def test_maps_of_the_globe_that_squeeze_the_ground_are_refused(
    tmp_path: Path, keys: Mapping[int, Any], east: float
) -> None:
    """But for the middle of a sinusoidal one, as surveys of planets have it."""
    tie = (0.0, 0.0, 0.0, east, 4.4e6, 0.0)  # at 40 deg
    raster = read(tmp_path, scale=(2.0, 2.0, 0.0), tie=tie, keys={MODEL_TYPE: 1, **keys})
    assert (raster.pixel == (2.0, 2.0)) is (keys.get(TRANSFORM) == 24 and east < 1e5)
    assert raster.pixel == (2.0, 2.0) or "gdalwarp" in str(raster.pixel)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({MODEL_TYPE: 2}, "its pixels are degrees (gdalwarp"),
        ({MODEL_TYPE: 3}, "its coordinates are geocentric (gdalwarp"),
        ({MODEL_TYPE: 1, LINEAR_UNIT: 9030}, "its unit 9030 is not known (gdalwarp"),
        ({MODEL_TYPE: 1, PROJECTED: 27291}, "its unit 32767 is not known (gdalwarp"),  # British yards
    ],
)
def test_degrees_and_unknown_units_are_named(tmp_path: Path, keys: Mapping[int, Any], said: str) -> None:
    near_a_pole = (0.0, 0.0, 0.0, 10.0, 89.0, 0.0)
    values = VALUES.astype(np.uint8)
    raster = read(tmp_path, scale=(1e-5, 1e-5, 0), tie=near_a_pole, keys=keys, values=values)
    assert isinstance(raster.pixel, str)
    assert raster.pixel.startswith(said)
    assert raster.in_metres is (keys[MODEL_TYPE] == 2)  # heights above degrees are in metres
    np.testing.assert_array_equal(raster.values, VALUES)
