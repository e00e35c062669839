import logging
import math
import re
import struct
import zlib
from collections.abc import Callable
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from harness.world.terrain_file import TerrainFile
from numpy.typing import NDArray
from PIL import Image
from scipy.ndimage import map_coordinates, uniform_filter1d

from harness.base.errors import UsageError
from harness.world.files import file_world
from harness.world.heightfield import filled, resampled
from harness.world.heightmap import raster as raster_module
from harness.world.heightmap.raster import read_raster
from harness.world.statistics import slopes
from harness.world.world import World, terrain_hash

Array = NDArray[np.float64]

MARSYARD = Path(__file__).parents[5] / "shared/data/marsyard/marsyard2021_terrain_hm.tif"
needs_marsyard = pytest.mark.skipif(not MARSYARD.exists(), reason=f"there is no {MARSYARD}")

PIXEL_SCALE, TIE_POINT, GEO_KEYS = 33550, 33922, 34735
UNKNOWN_SIZE = "does not say how large it is; give --terrain-size"


def hills(rows: int = 101, columns: int = 101) -> NDArray[np.float32]:
    """Gentle ground [m] for pixels of 0.2 m, level in the middle, higher in the south east."""
    y, x = np.mgrid[0:rows, 0:columns]
    bumps = 0.2 * np.cos((x - columns // 2) / 12) * np.cos((y - rows // 2) / 12)
    return np.asarray(bumps + 1e-3 * (x + y), np.float32)


def world_of(path: Path, size: float | None = 20.0, relief: float | None = None) -> World:
    return file_world(
        TerrainFile(path=path, size=None if size is None else (size, size), relief=relief), 0
    )


def saved(path: Path, values: NDArray[np.generic]) -> Path:
    np.save(path, values)
    return path


def write_geotiff(
    path: Path,
    values: NDArray[np.generic],
    pixel: float,
    *,
    depth: float | None = None,
    model_type: int = 1,
    unit: int = 9001,
) -> Path:
    """Of pixels `pixel` wide along x and `depth` along y; the unit is EPSG's number of it."""
    keys = (1, 1, 0, 2, 1024, 0, 1, model_type, 3076, 0, 1, unit)
    tags = [
        (PIXEL_SCALE, "d", 3, (pixel, pixel if depth is None else depth, 0.0), True),
        (TIE_POINT, "d", 6, (0.0, 0.0, 0.0, 500.0, 900.0, 0.0), True),
        (GEO_KEYS, "H", len(keys), keys, True),
    ]
    tifffile.imwrite(path, values, extratags=tags)
    return path


@needs_marsyard
def test_the_whole_marsyard_dem_is_driven_as_it_was_measured() -> None:
    world = file_world(TerrainFile(path=MARSYARD), 0)
    raw = tifffile.imread(MARSYARD)
    assert world.ground.cell == pytest.approx(0.094)
    np.testing.assert_allclose(world.ground.heights[::-1], raw - raw.min(), atol=2e-6)
    p50, p95 = np.percentile(slopes(world.ground), (50, 95))
    assert (p50, p95) == (pytest.approx(13.0, abs=0.1), pytest.approx(40.5, abs=0.1))
    assert world.start == (-0.799, -0.047, 0.0)  # beside the mound in the middle
    assert world.notes == (
        "its middle, the origin, is 0, -2 in its coordinates",
        "46.91 m along x, 46.91 m along y, 500 x 500 heights 0.094 m apart, relief 6.575 m",
        "starts at -0.799,-0.047: in its middle, 0,0, the ground is too steep",
    )


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("compression", [None, "zlib"])
def test_float_tiff_is_read_in_metres(tmp_path: Path, dtype: type, compression: str | None) -> None:
    tifffile.imwrite(tmp_path / "a.tif", hills().astype(dtype), compression=compression)
    heights = world_of(tmp_path / "a.tif").ground.heights
    np.testing.assert_allclose(heights[::-1], hills() - hills().min(), atol=2e-6)


@pytest.mark.parametrize(("dtype", "step"), [(np.uint8, 1 / 255), (np.uint16, 1 / 65535)])
def test_png_is_scaled_to_the_relief(tmp_path: Path, dtype: type, step: float) -> None:
    unit = (hills() - hills().min()) / np.ptp(hills())
    Image.fromarray((unit * np.iinfo(dtype).max).astype(dtype)).save(tmp_path / "a.png")
    world = world_of(tmp_path / "a.png", relief=0.5)
    np.testing.assert_allclose(world.ground.heights[::-1], 0.5 * unit, atol=step)
    assert "scaled to 0.5 m of relief" in world.notes[0]


def test_georeference_gives_the_size_and_the_flag_overrides_it(tmp_path: Path) -> None:
    path = write_geotiff(tmp_path / "a.tif", hills(), 0.2)
    assert world_of(path, size=None).ground.half_size == pytest.approx((10.0, 10.0))
    assert world_of(path, size=30.0).ground.half_size == pytest.approx((15.0, 15.0))
    write_geotiff(path, hills(), 1e-5, model_type=2)
    with pytest.raises(UsageError, match=r"pixels are degrees .*; give --terrain-size"):
        world_of(path, size=None)
    assert world_of(path).ground.half_size == pytest.approx((10.0, 10.0))


@pytest.mark.parametrize(
    ("width", "depth", "driven"),
    [(20.0, 9.0, False), (9.0, 20.0, False), (6e4, 20.0, False), (10.0, 10.0, True), (5e4, 5e4, True)],
)
def test_maps_of_ten_metres_to_fifty_kilometres_are_driven(
    tmp_path: Path, width: float, depth: float, *, driven: bool
) -> None:
    path = write_geotiff(tmp_path / "a.tif", np.zeros((129, 129)), width / 128, depth=depth / 128)
    said = re.escape(f"it is {width:g} x {depth:g} m; between 10 and 50000 m can be driven")
    with nullcontext() if driven else pytest.raises(UsageError, match=said):
        assert world_of(path, size=None).ground.half_size == (width / 2, depth / 2)


def test_whole_numbers_are_metres_if_the_file_is_georeferenced(tmp_path: Path) -> None:
    values = np.arange(101, dtype=np.uint16)[None] + np.zeros((101, 1), np.uint16)
    path = write_geotiff(tmp_path / "a.tif", values, 5.0)
    assert np.ptp(world_of(path, size=None).ground.heights) == 100.0
    tifffile.imwrite(tmp_path / "b.tif", values)
    with pytest.raises(
        UsageError, match="does not say that its values are metres; give --terrain-height"
    ):
        world_of(tmp_path / "b.tif")


@pytest.mark.parametrize(
    "options",
    [
        {"byteorder": ">"},
        {"compression": tifffile.COMPRESSION.DEFLATE},
        {"compression": "zlib", "predictor": True, "dtype": np.uint16},
        {"compression": "zlib", "predictor": True, "dtype": np.int8},  # which Pillow has not
    ],
)
def test_every_byte_order_and_deflate_is_read(tmp_path: Path, options: dict[str, Any]) -> None:
    values = np.arange(-32, 32).astype(options.pop("dtype", np.float32)).reshape(8, 8)
    tifffile.imwrite(tmp_path / "a.tif", values, **options)
    np.testing.assert_array_equal(read_raster(tmp_path / "a.tif").values, values)


@pytest.mark.parametrize("mode", ["1", "L", "I;16"])
def test_grey_pictures_are_read_as_they_are(tmp_path: Path, mode: str) -> None:
    picture = Image.new(mode, (9, 8))
    picture.putpixel((5, 2), 1)
    picture.save(tmp_path / "a.png")
    raster = read_raster(tmp_path / "a.png")
    assert raster.values.shape == (8, 9)
    assert np.argwhere(raster.values).tolist() == [[2, 5]]
    assert (raster.pixel, raster.in_metres) == ("it does not say how large it is", False)


@pytest.mark.parametrize("rows", [1, 200])  # of a strip; 200 are more than a SHORT counts bytes
def test_lzw_by_another_writer_is_read(tmp_path: Path, rows: int) -> None:
    heights = np.linspace(0.0, 1.0, 200 * 150, dtype=np.float32).reshape(200, 150)
    Image.fromarray(heights).save(tmp_path / "a.tif", compression="tiff_lzw", tiffinfo={278: rows})
    np.testing.assert_array_equal(read_raster(tmp_path / "a.tif").values, heights)


@pytest.mark.parametrize("dtype", [np.uint8, np.int16, np.float32])
def test_only_floats_of_an_array_are_metres(tmp_path: Path, dtype: type) -> None:
    raster = read_raster(saved(tmp_path / "a.npy", np.ones((9, 8), dtype)))
    assert raster.in_metres is (dtype is np.float32)
    assert (raster.values == 1.0).all()


@pytest.mark.parametrize(("rows", "columns"), [(7, 9), (9, 7)])
def test_a_side_of_fewer_than_eight_pixels_is_refused(tmp_path: Path, rows: int, columns: int) -> None:
    values = np.zeros((rows, columns), np.float32)
    tifffile.imwrite(tmp_path / "a.tif", values)
    for path in (tmp_path / "a.tif", saved(tmp_path / "a.npy", values)):
        with pytest.raises(UsageError, match=f"{columns} x {rows} pixels are too few; a side needs 8"):
            read_raster(path)
    assert read_raster(saved(tmp_path / "b.npy", np.zeros((8, 8)))).values.shape == (8, 8)


def test_sixteen_million_pixels_are_read_and_no_more() -> None:
    raster_module._check_size(4096, 4096)
    with pytest.raises(UsageError, match="4096 x 4097 pixels are too many; at most 17 million"):
        raster_module._check_size(4096, 4097)


@pytest.mark.parametrize(
    ("nodata", "value", "missing"),
    [("-9999", -9999.005, True), ("-9999", -9998.98, False), ("0", 0.0, True), ("0", 1e-9, False)],
)
def test_no_data_is_what_the_tag_says_but_for_rounding(
    tmp_path: Path, nodata: str, value: float, *, missing: bool
) -> None:
    values = np.full((9, 9), 5.0)
    values[3, 4] = value
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(42113, "s", 0, nodata, True)])
    assert np.argwhere(np.isnan(read_raster(tmp_path / "a.tif").values)).tolist() == [[3, 4]] * missing


@pytest.mark.parametrize(
    ("items", "expected"),
    [
        *(({"scale": 0.01, "offset": 100.0}, 112.5), ({"scale": 0.0, "offset": 7.0}, 7.0)),
        *(({"scale": 0.1}, 125.0), ({"offset": -50.0}, 1200.0)),
    ],
)
def test_gdals_scale_and_offset_make_heights_of_what_is_stored_but_not_of_no_data(
    tmp_path: Path, items: dict[str, float], expected: float
) -> None:
    values = np.full((9, 9), 1250, np.int16)
    values[3, 4] = -32768
    xml = "".join(f'<Item name="X" sample="0" role="{role}">{n}</Item>\n' for role, n in items.items())
    tags = [
        (42112, "s", 0, f"<GDALMetadata>{xml}</GDALMetadata>", True),
        (42113, "s", 0, "-32768", True),
    ]
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=tags)
    raster = read_raster(tmp_path / "a.tif")
    assert (raster.in_metres, len(raster.notes)) == (True, 1)
    assert np.unique(raster.values[np.isfinite(raster.values)]).tolist() == [pytest.approx(expected)]
    assert np.argwhere(np.isnan(raster.values)).tolist() == [[3, 4]]


def test_gdal_nodata_and_nan_are_filled_and_reported(tmp_path: Path) -> None:
    values = hills()
    values[10:15, 20:25] = -9999.0
    values[70, 70] = np.nan
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(42113, "s", 0, "-9999", True)])
    world = world_of(tmp_path / "a.tif")
    assert world.notes[0] == "26 missing heights (0.25%) filled from their surroundings"
    np.testing.assert_allclose(world.ground.heights[::-1], hills() - hills().min(), atol=0.05)


def pull_push(values: Array) -> Array:
    """What `filled` promises, by other means: means of blocks, then back between their middles."""
    if not np.isnan(values).any():
        return values
    coarse = np.full([(size + 1) // 2 for size in values.shape], np.nan)
    for row, column in np.ndindex(*coarse.shape):
        block = values[2 * row : 2 * row + 2, 2 * column : 2 * column + 2]
        if not np.isnan(block).all():
            coarse[row, column] = np.nanmean(block)
    middles = (np.indices(values.shape) - 0.5) / 2
    smooth = map_coordinates(pull_push(coarse), middles, order=1, mode="nearest")
    return np.where(np.isnan(values), smooth, values)


@pytest.mark.parametrize("shape", [(40, 57), (9, 8)])
def test_gaps_are_filled_by_a_pyramid_of_means(shape: tuple[int, int]) -> None:
    rng = np.random.default_rng(0)
    values = rng.normal(size=shape)
    values[2:7, 3:8] = np.nan
    values[-1, -1] = values[0, 1] = np.nan
    np.testing.assert_allclose(filled(values), pull_push(values), atol=1e-12)


@pytest.mark.parametrize(
    ("step", "shape"),
    # The last one reaches the edges, with means over five pixels.
    [((3.0, 3.0), (21, 20)), ((2.6, 1.2), (24, 50)), ((0.5, 4.4), (99, 14)), ((4.0, 4.0), (16, 16))],
)
def test_coarser_cells_are_means_around_their_places_in_the_middle(
    step: tuple[float, float], shape: tuple[int, int]
) -> None:
    values = np.random.default_rng(0).normal(size=(64, 61))
    expected = values
    for axis, stride in enumerate(step):
        expected = uniform_filter1d(expected, 2 * (round(stride) // 2) + 1, axis=axis, mode="nearest")
    down, across = (np.arange(count) - (count - 1) / 2 for count in shape)
    places = np.meshgrid(31.5 + step[0] * down, 30.0 + step[1] * across, indexing="ij")
    expected = map_coordinates(expected, places, order=1, mode="nearest")
    np.testing.assert_allclose(resampled(values, step, shape), expected, atol=1e-12)


def test_fine_pixels_become_cells_of_5_cm(tmp_path: Path) -> None:
    world = world_of(saved(tmp_path / "a.npy", hills(1001, 1001) * 0.02))
    assert world.ground.cell == 0.05
    assert "pixels of 0.02 x 0.02 m resampled to cells of 0.05 m" in world.notes[0]


def test_huge_maps_are_kept_to_what_memory_holds(tmp_path: Path) -> None:
    world = world_of(saved(tmp_path / "a.npy", np.zeros((1800, 1800), np.float32)), size=1799.0)
    assert world.ground.heights.shape == (1500, 1500)
    assert world.ground.half_size == pytest.approx((899.5, 899.5))
    file = TerrainFile(
        path=saved(tmp_path / "b.npy", np.zeros((8, 9000), np.float32)), size=(8999.0, 10.0)
    )
    assert file_world(file, 0).ground.heights.shape == (11, 9000)  # long is not huge


def test_oblong_maps_are_driven_whole_with_north_up(tmp_path: Path) -> None:
    """A plane of its own slope along x and along y, and a mark in the north-east corner."""
    row, column = np.mgrid[0:101, 0:201]
    values = 0.02 * column - 0.004 * row
    values[0, -1] += 1.0
    path = saved(tmp_path / "a.npy", values)
    world = file_world(TerrainFile(path=path, size=(40.0, 20.0)), seed=7)
    ground = world.ground
    np.testing.assert_allclose(ground.heights[::-1], values - values.min(), atol=1e-6)
    assert (ground.cell, *ground.half_size) == pytest.approx((0.2, 20.0, 10.0))
    assert ground.height_at(20.0, 10.0) == pytest.approx(ground.heights.max())
    assert ground.height_at(19.0, -9.0) - ground.height_at(-19.0, -9.0) == pytest.approx(38 * 0.1)
    assert ground.height_at(3.0, 9.0) - ground.height_at(3.0, -9.0) == pytest.approx(18 * 0.02)
    assert world.notes == ("40 m along x, 20 m along y, 201 x 101 heights 0.2 m apart, relief 5.4 m",)
    assert (world.name, world.seed, world.difficulty, world.obstacles) == ("a.npy", 7, None, ())
    assert world.start == (0.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("shape", "size", "expected", "note"),
    [
        ((101, 101), (30.0, 20.0), (101, 151), "pixels of 0.3 x 0.2 m resampled to cells of 0.2 m"),
        ((60, 41), (40.8, 59.0), (60, 41), "{}, 0.8 m along x and 0 m along y cut off at the edges"),
        ((41, 60), (59.0, 40.8), (41, 60), "{}, 0 m along x and 0.8 m along y cut off at the edges"),
        # 100 x 1.43 m: one column of a square of 10 m was left of it
        ((8, 8), (700.0, 10.0), (8, 491), "pixels of 100 x 1.429 m resampled to cells of 1.429 m"),
    ],
)
def test_pixels_that_are_no_squares_are_resampled_and_what_is_cut_off_is_told(
    tmp_path: Path,
    shape: tuple[int, int],
    size: tuple[float, float],
    expected: tuple[int, int],
    note: str,
) -> None:
    """A plane keeps its slopes along x and y, in metres, and its middle in the middle."""
    rows, columns = shape
    row, column = np.indices(shape)
    width, depth = size[0] / (columns - 1), size[1] / (rows - 1)
    values = 0.03 * width * (column - (columns - 1) / 2) - 0.02 * depth * (row - (rows - 1) / 2)
    ground_file = TerrainFile(path=saved(tmp_path / "a.npy", values), size=size)
    world = file_world(ground_file, 0)
    ground = world.ground
    assert ground.heights.shape == expected
    half_x, half_y = ground.half_size
    x, y = 0.8 * half_x, 0.5 * half_y
    rise_x = ground.height_at(x, 0.0) - ground.height_at(-x, 0.0)
    rise_y = ground.height_at(0.0, y) - ground.height_at(0.0, -y)
    assert (rise_x, rise_y) == pytest.approx((2 * x * 0.03, 2 * y * 0.02), rel=1e-3)
    pixels = f"pixels of {width:.4g} x {depth:.4g} m resampled to cells of {min(width, depth):.4g} m"
    assert world.notes[0] == note.format(pixels)
    assert f"relief {np.ptp(ground.heights):.4g} m" in world.notes[1]


def test_up_to_half_of_the_heights_may_be_missing(tmp_path: Path) -> None:
    values = np.where(np.arange(400) < 200, np.nan, 0.0).reshape(20, 20)
    told = "200 missing heights (50.00%) filled from their surroundings"
    assert world_of(saved(tmp_path / "a.npy", values)).notes[0] == told
    values[-1, -1] = np.nan
    with pytest.raises(UsageError, match=r"50% of its heights are missing; at most 50% are filled"):
        world_of(saved(tmp_path / "a.npy", values))


@pytest.mark.parametrize(
    ("rest", "corner", "relief", "said"),
    [
        (0.0, 10_000.0, 10_000.0, ""),
        (0.0, 10_001.0, 0.0, "its relief is 10001 m; give --terrain-height if that is no metres"),
        (19_999.0, 20_000.0, 1.0, ""),
        *((0.0, gone, 0.0, "") for gone in (20_001.0, -20_001.0, math.inf, -math.inf)),  # filled
    ],
)
def test_heights_beyond_any_mountain_are_refused_or_missing(
    tmp_path: Path, rest: float, corner: float, relief: float, said: str
) -> None:
    values = np.full((41, 41), rest)
    values[0, 0] = corner
    with pytest.raises(UsageError, match=said) if said else nullcontext():
        assert np.ptp(world_of(saved(tmp_path / "a.npy", values)).ground.heights) == relief


def test_values_without_a_unit_are_scaled_from_the_lowest_to_the_highest(tmp_path: Path) -> None:
    values = np.tile(np.linspace(30_000, 60_000, 41).astype(np.uint16), (41, 1))
    world = world_of(saved(tmp_path / "a.npy", values), relief=2.0)
    assert world.ground.heights[0, [0, 20, 40]] == pytest.approx((0.0, 1.0, 2.0), abs=1e-4)
    assert world.notes[0] == "values 30000 to 60000 scaled to 2 m of relief"
    level = world_of(saved(tmp_path / "b.npy", np.full((41, 41), 7, np.uint8)), relief=0.0)
    assert (level.ground.heights == 0.0).all()


@pytest.mark.parametrize(
    ("size", "first_level", "start"),
    # 45 deg up to a column, level from there on; no ground within 0.4 m may be steeper than 15 deg.
    [(20.0, 56, 59), (15.0, 56, 60), (20.0, 72, 75), (20.0, 73, None), (20.0, 40, 50)],
)
def test_the_start_is_the_vertex_next_to_the_middle_with_gentle_ground_around_it(
    tmp_path: Path, size: float, first_level: int, start: int | None
) -> None:
    cell = size / 100
    profile = cell * np.minimum(np.arange(101.0), first_level)
    path = saved(tmp_path / "a.npy", np.tile(profile, (121, 1)))
    sideways = saved(tmp_path / "b.npy", np.tile(profile[:, None], (1, 121)))
    sizes = (size, 1.2 * size), (1.2 * size, size)
    across, along = (TerrainFile(path=p, size=s) for p, s in zip((path, sideways), sizes, strict=True))
    if start is None:
        for file in (across, along):
            with pytest.raises(
                UsageError, match=r"no rover can stand within 5\.05 m .*choose a --start"
            ):
                file_world(file, 0)
            assert file_world(replace(file, needs_start=False), 0).start == (0.0, 0.0, 0.0)
        return
    moved = round((start - 50) * cell, 3)
    for file, (width, depth), x, y in (
        (across, sizes[0], moved, 0.0),
        (along, sizes[1], 0.0, -moved),  # the first row is in the north
    ):
        world = file_world(file, 0)
        assert world.start == (x, y, 0.0)
        told = (f"starts at {x:g},{y:g}: in its middle, 0,0, the ground is too steep",)
        assert world.notes[1:] == (told if moved else ())
        assert world.ground.half_size == pytest.approx((width / 2, depth / 2))


def test_dem_on_which_no_rover_can_stand_is_refused(tmp_path: Path) -> None:
    steps = np.where(np.arange(101) < 50, 0.2, 0.3)  # [m] from cell to cell of 0.2 m
    path = saved(tmp_path / "a.npy", np.tile(steps.cumsum(), (101, 1)))
    with pytest.raises(UsageError, match=r"no rover can stand within 5\.05 m .* 45 deg steep"):
        world_of(path)


def test_zeros_of_either_sign_are_the_same_ground(tmp_path: Path) -> None:
    level, signed = np.zeros((2, 51, 51))
    signed[7:20, 7:20] = -0.0
    worlds = [world_of(saved(tmp_path / "a.npy", heights)) for heights in (level, signed)]
    assert terrain_hash(worlds[0]) == terrain_hash(worlds[1])


def _nothing(_: Path) -> None:
    """Leaves the file missing."""


def _huge_npy(path: Path) -> None:
    with path.open("wb") as file:
        header = {"descr": "<f4", "fortran_order": False, "shape": (10000, 10000)}
        np.lib.format.write_array_header_1_0(file, header)
        file.truncate(400_000_200)  # sparse: takes no room


def _patched(path: Path, tags: dict[str, int], length: int = 2, **options: Any) -> None:  # noqa: ANN401
    """64-bit floats whose file says something else of itself."""
    tifffile.imwrite(path, np.zeros((64, 64)), **options)
    with tifffile.TiffFile(path) as file:
        fields = [file.pages.first.tags[name].valueoffset for name in tags]
    data = bytearray(path.read_bytes())
    for field, value in zip(fields, tags.values(), strict=True):
        data[field : field + length] = value.to_bytes(length, "little")
    path.write_bytes(data)


def _bomb(path: Path) -> None:
    bomb = zlib.compress(bytes(20_000_000), 9)
    packed: dict[str, Any] = {"compression": "zlib", "rowsperstrip": 64}
    _patched(path, {}, **packed)
    _patched(path, {"StripOffsets": path.stat().st_size, "StripByteCounts": len(bomb)}, 4, **packed)
    with path.open("ab") as file:
        file.write(bomb)


def _png_header(path: Path, columns: int, rows: int) -> None:
    """The signature and the first chunk: what is looked at before anything is decoded."""
    header = struct.pack(">4sIIBBBBB", b"IHDR", columns, rows, 8, 0, 0, 0, 0)
    end = struct.pack(">I4sI", 0, b"IDAT", zlib.crc32(b"IDAT"))
    crc = struct.pack(">I", zlib.crc32(header))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + crc + end)


def _bands(path: Path) -> None:
    tifffile.imwrite(path, np.zeros((64, 64, 3), np.uint8), photometric="rgb")


def _cut(path: Path) -> None:
    whole = path.with_name("whole" + path.suffix)
    if path.suffix == ".npy":
        np.save(whole, hills())
    elif path.suffix == ".png":
        Image.fromarray((hills() * 1e4).astype(np.uint16)).save(whole)
    else:
        tifffile.imwrite(whole, hills())
    path.write_bytes(whole.read_bytes()[:2000])


def _noise(path: Path) -> None:
    _cut(path)
    noise = np.random.default_rng(0).integers(0, 256, 3000, np.uint8).tobytes()
    path.write_bytes(path.read_bytes()[:20] + noise)


BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing.tif": (_nothing, "cannot be read: No such file"),
    "nul\0.tif": (_nothing, "cannot be read: embedded null byte"),
    "folder.tif": (lambda path: path.mkdir(), "Is a directory"),
    "empty.tif": (lambda path: path.touch(), "is empty"),
    "text.tif": (lambda path: path.write_text("x,y,z\n1,2,3\n"), "is not a heightmap; readable are"),
    "cut.tif": (_cut, "damaged or cut short"),
    "cut.png": (_cut, "damaged or cut short"),
    "cut.npy": (_cut, "damaged or cut short"),
    "noise.tif": (_noise, "noise.tif"),
    "noise.png": (_noise, "damaged or cut short"),
    "noise.npy": (_noise, "damaged or cut short"),
    "bomb.tif": (_bomb, "unpacks to more than its size"),
    "bomb.png": (lambda path: _png_header(path, 30000, 30000), "too many pixels"),
    "huge.png": (lambda path: _png_header(path, 12500, 8000), "12500 x 8000 pixels are too many"),
    "huge.npy": (_huge_npy, "10000 x 10000 pixels are too many"),
    "one.npy": (lambda path: np.save(path, np.zeros((1, 1))), "1 x 1 pixels are too few"),
    "nan.npy": (lambda path: np.save(path, np.full((50, 50), np.nan)), "holds no height at all"),
    "half.npy": (lambda path: np.save(path, np.pad(hills(), 60, constant_values=np.nan)), "are missing"),
    "cube.npy": (lambda path: np.save(path, np.zeros((9, 9, 9))), "a heightmap has 2"),
    "text.npy": (lambda path: np.save(path, np.full((9, 9), "a")), "heights are numbers"),
    "color.png": (lambda path: Image.new("RGB", (50, 50)).save(path), "a colour picture"),
    "bands.tif": (_bands, "it has 3 bands; a heightmap has one (gdal_translate"),
    "photo-cd.png": (
        lambda path: path.write_bytes(b"\x89PNG".ljust(2048) + b"PCD_".ljust(2048)),
        "damaged or cut short",
    ),
    "jpeg.tif": (
        lambda path: _patched(path, {"Compression": tifffile.COMPRESSION.JPEG}),
        "float64 values with JPEG compression are not read",
    ),
    "tile.tif": (
        lambda path: _patched(
            path, {"TileWidth": 0xFFF0, "TileLength": 0xFFF0}, tile=(16, 16), compression="zlib"
        ),
        "pixels are too many",
    ),
    "5-bit.tif": (
        lambda path: _patched(path, {"BitsPerSample": 5}),
        "None values with NONE compression are not read",
    ),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_file_is_one_line_that_names_it(name: str, tmp_path: Path) -> None:
    make, expected = BAD[name]
    path = tmp_path / name
    make(path)
    with pytest.raises(UsageError) as caught:
        world_of(path)
    message = str(caught.value)
    assert expected in message
    assert str(path) in message
    assert "\n" not in message


def test_what_the_decoder_finds_is_told_in_the_one_line_alone(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    logging.getLogger("tifffile").setLevel(logging.NOTSET)
    _noise(tmp_path / "a.tif")
    with pytest.raises(UsageError):
        read_raster(tmp_path / "a.tif")
    assert caplog.records == []


def test_pickles_are_never_loaded(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.array([[print] * 9] * 9, dtype=object), allow_pickle=True)
    with pytest.raises(UsageError, match=r"damaged or cut short: .*object"):
        read_raster(tmp_path / "a.npy")


def test_what_a_file_does_not_say_is_asked_for(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=UNKNOWN_SIZE):
        world_of(saved(tmp_path / "a.npy", hills()), size=None)
    Image.fromarray((hills() * 100).astype(np.uint8)).save(tmp_path / "a.png")
    with pytest.raises(UsageError, match="give --terrain-height"):
        world_of(tmp_path / "a.png")
