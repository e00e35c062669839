"""Worlds from heightmaps that tifffile, Pillow and numpy have written, and files that are none."""

import logging
import math
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tifffile
from numpy.typing import NDArray
from PIL import Image

from harness.base.errors import UsageError
from harness.spec.value import made
from harness.spec.world import WorldSpec
from harness.world.files import file_world
from harness.world.heightmap.raster import read_raster
from harness.world.statistics import slopes
from harness.world.world import RoverNeeds, World

MARSYARD = Path(__file__).parents[5] / "shared/data/marsyard/marsyard2021_terrain_hm.tif"
needs_marsyard = pytest.mark.skipif(not MARSYARD.exists(), reason=f"there is no {MARSYARD}")

PIXEL_SCALE, TIE_POINT, GEO_KEYS, METADATA, NODATA = 33550, 33922, 34735, 42112, 42113


def hills(rows: int = 101, columns: int = 101) -> NDArray[np.float32]:
    """Gentle ground [m] for pixels of 0.2 m, level in the middle, higher in the south east."""
    y, x = np.mgrid[0:rows, 0:columns]
    bumps = 0.2 * np.cos((x - columns // 2) / 12) * np.cos((y - rows // 2) / 12)
    return np.asarray(bumps + 1e-3 * (x + y), np.float32)


def world_of(path: Path, *, needs_start: bool = True, seed: int = 0, **fields: Any) -> World:  # noqa: ANN401 - as the fields are
    spec = made(WorldSpec, {"terrain": str(path), "terrain_size": 20.0} | fields)
    return file_world(spec, RoverNeeds(needs_start=needs_start), seed)


def saved(path: Path, values: NDArray[np.generic]) -> Path:
    np.save(path, values)
    return path


def write_geotiff(path: Path, values: NDArray[np.generic], *pixel: float, model_type: int = 1) -> Path:
    """Of pixels that wide and that deep, in metres or, of model type 2, in degrees."""
    keys = (1, 1, 0, 2, 1024, 0, 1, model_type, 3076, 0, 1, 9001)
    tags = [
        (PIXEL_SCALE, "d", 3, (pixel[0], pixel[-1], 0.0), True),
        (TIE_POINT, "d", 6, (0.0, 0.0, 0.0, 500.0, 900.0, 0.0), True),
        (GEO_KEYS, "H", len(keys), keys, True),
    ]
    tifffile.imwrite(path, values, extratags=tags)
    return path


@needs_marsyard
def test_the_whole_marsyard_dem_is_driven_as_it_was_measured() -> None:
    world = world_of(MARSYARD, terrain_size=None)
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


def test_a_strip_of_more_bytes_than_a_short_counts_is_read_as_pillow_wrote_it(tmp_path: Path) -> None:
    heights = np.linspace(0.0, 1.0, 200 * 150, dtype=np.float32).reshape(200, 150)
    Image.fromarray(heights).save(tmp_path / "a.tif", compression="tiff_lzw", tiffinfo={278: 200})
    np.testing.assert_array_equal(read_raster(tmp_path / "a.tif").values, heights)


def test_size_is_as_the_file_says_unless_the_option_overrides_it(tmp_path: Path) -> None:
    path = write_geotiff(tmp_path / "a.tif", hills(), 0.2)
    assert world_of(path, terrain_size=None).ground.half_size == pytest.approx((10.0, 10.0))
    assert world_of(path, terrain_size=30.0).ground.half_size == pytest.approx((15.0, 15.0))
    whole = np.arange(101, dtype=np.uint16)[None] + np.zeros((101, 1), np.uint16)
    write_geotiff(path, whole, 5.0)  # whole numbers are metres where pixels are
    assert np.ptp(world_of(path, terrain_size=None).ground.heights) == 100.0
    for length in (10.0, 5e4):
        _mapped(length)(path)
        assert world_of(path, terrain_size=None).ground.half_size == (length / 2,) * 2
    write_geotiff(path, hills(), 1e-5, model_type=2)
    assert world_of(path).ground.half_size == pytest.approx((10.0, 10.0))


@pytest.mark.parametrize(
    ("rows", "columns", "width", "depth", "east", "north"),
    [(8, 60, 10.0, 80.0, 0.1, -0.07), (33, 20, 80.0, 11.3, -0.03, 0.1), (60, 60, 10.0, 12.0, 0.0, 0.05)],
)
def test_a_plane_keeps_its_slopes_size_and_middle_whatever_its_pixels(
    tmp_path: Path, rows: int, columns: int, width: float, depth: float, east: float, north: float
) -> None:
    """The first row is in the north, and square cells are no larger than either side of a pixel."""
    row, column = np.indices((rows, columns))
    pixel = width / (columns - 1), depth / (rows - 1)
    values = east * pixel[0] * column - north * pixel[1] * row
    path = saved(tmp_path / "plane.npy", values)
    world = world_of(path, terrain_size=(width, depth), needs_start=False, seed=7)
    ground, cell = world.ground, world.ground.cell
    assert cell == pytest.approx(min(pixel)) or cell == 0.05 > min(pixel)
    for half, length in zip(ground.half_size, (width, depth), strict=True):
        assert length - cell < 2 * half <= length + 1e-6
    x, y = 0.4 * width, 0.4 * depth
    rises = (
        ground.height_at(x, 0) - ground.height_at(-x, 0),
        ground.height_at(0, y) - ground.height_at(0, -y),
    )
    assert rises == pytest.approx(
        (2 * x * east, 2 * y * north), abs=0.01 * (abs(east) + abs(north)) + 1e-5
    )
    assert ground.heights.min() == 0.0
    assert (world.name, world.seed, world.difficulty, world.obstacles) == ("plane.npy", 7, None, ())


@pytest.mark.parametrize(
    ("shape", "size", "expected", "note"),
    [
        ((101, 101), (30.0, 20.0), (101, 151), "pixels of 0.3 x 0.2 m resampled to cells of 0.2 m"),
        ((41, 60), (59.0, 40.8), (41, 60), ", 0 m along x and 0.8 m along y cut off at the edges"),
        ((1001, 1001), (20.0, 20.0), (401, 401), "pixels of 0.02 x 0.02 m resampled to cells of 0.05 m"),
        ((1800, 1800), (1799.0, 1799.0), (1500, 1500), "resampled"),  # what memory holds
        ((8, 9000), (8999.0, 10.0), (11, 9000), "resampled"),  # long is not huge
        ((8, 8), (700.0, 10.0), (8, 491), "pixels of 100 x 1.429 m resampled to cells of 1.429 m"),
    ],
)
def test_pixels_are_resampled_to_square_cells_that_can_be_simulated(
    tmp_path: Path, shape: tuple[int, int], size: tuple[float, float], expected: object, note: str
) -> None:
    world = world_of(saved(tmp_path / "a.npy", np.zeros(shape, np.float32)), terrain_size=size)
    assert world.ground.heights.shape == expected
    assert note in world.notes[0]


def test_missing_heights_are_filled_and_counted(tmp_path: Path) -> None:
    values = hills()
    values[10:15, 20:25] = -9999.0
    values[70, 70] = np.nan
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(NODATA, "s", 0, "-9999", True)])
    world = world_of(tmp_path / "a.tif")
    assert world.notes[0] == "26 missing heights (0.25%) filled from their surroundings"
    np.testing.assert_allclose(world.ground.heights[::-1], hills() - hills().min(), atol=0.05)
    half = np.where(np.arange(400) < 200, np.nan, 0.0).reshape(20, 20)
    assert "(50.00%) filled" in world_of(saved(tmp_path / "a.npy", half)).notes[0]


@pytest.mark.parametrize(
    ("nodata", "value", "missing"),
    [
        *(("-9999", -9999.005, True), ("-9999", -9998.98, False), ("0", 0.0, True), ("0", 1e-9, False)),
        *((None, gone, True) for gone in (20_001.0, -20_001.0, math.inf, -math.inf, math.nan)),
        *((None, -20_000.0, False), (None, -9999.0, True)),
    ],
)
def test_missing_is_what_the_tag_says_and_what_is_beyond_any_mountain(
    tmp_path: Path, nodata: str | None, value: float, *, missing: bool
) -> None:
    values = np.full((9, 9), 5.0)
    values[3, 4] = value
    tags = [] if nodata is None else [(NODATA, "s", 0, nodata, True)]
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=tags)
    assert np.argwhere(np.isnan(read_raster(tmp_path / "a.tif").values)).tolist() == [[3, 4]] * missing


@pytest.mark.parametrize(
    ("above", "hole", "doubted"),
    [(1500.0, 0.0, True), (-4500.0, 0.0, True), (0.3, 0.0, False), (1500.0, 1.0, False),
     (1500.0, -999.0, True), (1500.0, 9999.0, True), (-998.7, -999.0, False)],
)  # fmt: skip
def test_marks_of_no_data_far_from_all_other_heights_are_doubted(
    tmp_path: Path, above: float, hole: float, *, doubted: bool
) -> None:
    heights = above + hills()
    heights[:10] = hole
    notes = world_of(saved(tmp_path / "dem.npy", heights)).notes
    assert any(f"nodata {hole:g} " in note and "1010 of its" in note for note in notes) is doubted


def test_zeros_of_a_plane_with_a_step_are_not_doubted(tmp_path: Path) -> None:
    heights = np.zeros((101, 101))
    heights[:40] = 0.3
    assert not any("nodata" in note for note in world_of(saved(tmp_path / "step.npy", heights)).notes)


def test_gdals_scale_and_offset_apply_to_heights_but_not_to_missing_ones(tmp_path: Path) -> None:
    values = np.full((9, 9), 1250, np.int16)
    values[3, 4] = -32768
    for items, expected in (
        *(({"scale": 0.01, "offset": 100.0}, 112.5), ({"scale": 0.0, "offset": 7.0}, 7.0)),
        *(({"scale": 0.1}, 125.0), ({"offset": -50.0}, 1200.0)),
    ):
        xml = "".join(f'<Item name="X" role="{role}">{n}</Item>\n' for role, n in items.items())
        texts = ((METADATA, f"<GDALMetadata>{xml}</GDALMetadata>"), (NODATA, "-32768"))
        tags = [(tag, "s", 0, text, True) for tag, text in texts]
        tifffile.imwrite(tmp_path / "a.tif", values, extratags=tags)
        raster = read_raster(tmp_path / "a.tif")
        assert (raster.in_metres, len(raster.notes)) == (True, 1)
        found = np.unique(raster.values[np.isfinite(raster.values)])
        assert found.tolist() == [pytest.approx(expected)]
        assert np.argwhere(np.isnan(raster.values)).tolist() == [[3, 4]]


@pytest.mark.parametrize(("kind", "step"), [(np.uint8, 1 / 255), (np.uint16, 1 / 65535)])
def test_values_without_a_unit_are_scaled_from_lowest_to_highest(
    tmp_path: Path, kind: type, step: float
) -> None:
    unit = (hills() - hills().min()) / np.ptp(hills())
    Image.fromarray((unit * np.iinfo(kind).max).astype(kind)).save(tmp_path / "a.png")
    world = world_of(tmp_path / "a.png", terrain_height=0.5)
    np.testing.assert_allclose(world.ground.heights[::-1], 0.5 * unit, atol=step)
    assert "scaled to 0.5 m of relief" in world.notes[0]
    level = world_of(saved(tmp_path / "b.npy", np.full((41, 41), 7, kind)), terrain_height=0.0)
    assert (level.ground.heights == 0.0).all()


@pytest.mark.parametrize(
    ("size", "first_level", "start"),
    # 45 deg up to a column, level from there on; no ground within 0.4 m may be steeper than 15 deg.
    [(15.0, 56, 60), (20.0, 72, 75), (20.0, 73, None), (20.0, 40, 50)],
)
@pytest.mark.parametrize("is_along_x", [True, False])
def test_the_start_is_the_vertex_next_to_the_middle_with_gentle_ground_around_it(
    tmp_path: Path, size: float, first_level: int, start: int | None, *, is_along_x: bool
) -> None:
    cell = size / 100
    profile = np.tile(cell * np.minimum(np.arange(101.0), first_level), (121, 1))
    sizes = (size, 1.2 * size)
    path = saved(tmp_path / "a.npy", profile if is_along_x else profile.T)
    given: dict[str, Any] = {"terrain_size": sizes if is_along_x else sizes[::-1]}
    assert world_of(path, **given, needs_start=False).start == (0.0, 0.0, 0.0)
    if start is None:
        with pytest.raises(UsageError, match=r"no rover can stand within 5\.05 m .*choose a --start"):
            world_of(path, **given)
        return
    moved = round((start - 50) * cell, 3)
    world = world_of(path, **given)
    assert world.start == ((moved, 0.0, 0.0) if is_along_x else (0.0, -moved, 0.0))  # north is first
    assert len(world.notes) == 1 + bool(moved)


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


def _png_header(path: Path, columns: int, rows: int, bits: int = 8, colours: int = 0) -> None:
    """The signature and the first chunk: what is looked at before anything is decoded."""
    header = struct.pack(">4sIIBBBBB", b"IHDR", columns, rows, bits, colours, 0, 0, 0)
    end = struct.pack(">I4sI", 0, b"IDAT", zlib.crc32(b"IDAT"))
    crc = struct.pack(">I", zlib.crc32(header))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + header + crc + end)


def _cut(path: Path) -> None:
    if path.suffix == ".npy":
        np.save(path, hills())
    elif path.suffix == ".png":
        Image.fromarray((hills() * 1e4).astype(np.uint16)).save(path)
    else:
        tifffile.imwrite(path, hills())
    path.write_bytes(path.read_bytes()[:2000])


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize(
    ("keys", "crs", "pixel", "metres"),
    [
        ("cellsize 0.25", "", (0.25, 0.25), 1.0),
        ("dx 0.25\ndy 0.5", 'PROJCS["a",UNIT["Meter",1.0]]', (0.25, 0.5), 1.0),
        ("CELLSIZE 1", 'PROJCS["a",UNIT["Foot",0.3048]]', (0.3048, 0.3048), None),
        (
            "cellsize 1",
            'PROJCS["a",UNIT["Foot",0.3048]],VERTCS["b",UNIT["Foot",0.3048]]',
            (0.3048,) * 2,
            0.3048,
        ),
        (
            "cellsize 1",
            'PROJCS["a",UNIT["Foot",0.3048]],VERTCS["b",UNIT["Meter",1.0]]',
            (0.3048,) * 2,
            1.0,
        ),
        ("cellsize 1", "Projection  STATEPLANE\nUnits  FEET\n", (0.3048,) * 2, None),
        ("cellsize 0.01", "Projection  GEOGRAPHIC\nUnits  DD\n", "its cells are degrees", 1.0),
        ("cellsize -1", "", "it does not say how large it is", 1.0),
        ("cellsize 0.00001", "", "its cells are degrees", 1.0),
        *(
            ("cellsize 1", f'PROJCS["a",PROJECTION["{name}"]', "its map's metres are not", 1.0)
            for name in ("Mercator_Auxiliary_Sphere", "Equidistant_Cylindrical", "Mollweide")
        ),
        ("cellsize 1", 'GEOGCS["a",UNIT["Degree",0.0174532925199433]]', "its cells are degrees", 1.0),
    ],
)
def test_a_grid_of_esri_is_read_with_its_units(
    keys: str,
    crs: str,
    pixel: tuple[float, float] | str,
    metres: float | None,
    decimal: str,
    tmp_path: Path,
) -> None:
    heights = np.arange(90.0).reshape(9, 10) / 4
    rows = "\n".join(" ".join(f"{height:.2f}" for height in row) for row in heights)
    text = f"xllcorner 500.5\nncols 10\nnrows 9\nyllcorner 7\n{keys}\nNODATA_value 3.5\n{rows}\n"
    (tmp_path / "a.asc").write_text(text.replace(".", decimal), "utf-8-sig" if crs else "ascii")
    if crs:
        (tmp_path / "a.prj").write_text(crs)
    raster = read_raster(tmp_path / "a.asc")
    assert raster.in_metres is (metres is not None)
    np.testing.assert_allclose(
        raster.values, np.where(heights == 3.5, np.nan, heights) * (metres or 1.0)
    )
    if isinstance(pixel, str):
        assert str(raster.pixel).startswith(pixel)
    else:
        assert raster.pixel == pytest.approx(pixel)


def _array(values: object, **options: Any) -> Callable[[Path], None]:  # noqa: ANN401 - numpy's
    return lambda path: np.save(path, np.asarray(values), **options)


def _tiff(values: NDArray[np.generic], **options: Any) -> Callable[[Path], object]:  # noqa: ANN401
    return lambda path: tifffile.imwrite(path, values, **options)


def _tile(path: Path) -> None:
    _patched(path, {"TileWidth": 0xFFF0, "TileLength": 0xFFF0}, tile=(16, 16), compression="zlib")


def _mapped(*size: float) -> Callable[[Path], object]:
    return lambda path: write_geotiff(path, np.zeros((129, 129)), *(length / 128 for length in size))


STEEP = np.tile(np.where(np.arange(101) < 50, 0.2, 0.3).cumsum(), (101, 1))
PICTURE = hills().astype(np.uint8)
BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "missing.tif": (lambda _: None, "cannot be read: No such file"),
    "nul\0.tif": (lambda _: None, "cannot be read: embedded null byte"),
    "folder.tif": (Path.mkdir, "Is a directory"),
    "empty.tif": (Path.touch, "is empty"),
    "pointer.tif": (
        lambda path: path.write_text("version https://git-lfs.github.com/spec/v1\n"),
        "is only Git LFS's pointer to it; git lfs pull fetches it",
    ),
    "text.tif": (lambda path: path.write_text("x,y,z\n1,2,3\n"), "is not a heightmap; readable: "),
    **{f"cut{kind}": (_cut, "damaged or cut short") for kind in (".tif", ".png", ".npy")},
    "bomb.tif": (_bomb, "unpacks to more than its size"),
    "bomb.png": (lambda path: _png_header(path, 30000, 30000), "too many pixels"),
    "more.png": (lambda path: _png_header(path, 4096, 4097), "4096 x 4097 pixels are too many"),
    "short.asc": (
        lambda path: path.write_text("ncols 9\nnrows 9\ncellsize 1\n1 2 3"),
        "it has 3 heights, not 9 x 9",
    ),
    "keyless.asc": (lambda path: path.write_text("ncols 9\n1 2 3"), "its header has no nrows with a"),
    "comment.asc": (
        lambda path: path.write_text(f"ncols 9\nnrows 9\ncellsize 1\n{'-1.5e0 nan ' * 40} #1"),
        "'#1' is no height; give numbers apart by blanks",
    ),
    "wide.asc": (lambda path: path.write_text("ncols 9999\nnrows 9999\n1"), "too many"),
    "narrow.tif": (_tiff(np.zeros((9, 7))), "7 x 9 pixels are too few"),
    "low.npy": (_array(np.zeros((7, 9))), "9 x 7 pixels are too few"),
    "nan.npy": (_array(np.full((50, 50), np.nan)), "holds no height at all"),
    "half.npy": (_array(np.where(np.arange(400) < 201, np.nan, 0.0).reshape(20, 20)), "are missing"),
    "cube.npy": (_array(np.zeros((9, 9, 9))), "a heightmap has 2"),
    "text.npy": (_array(np.full((9, 9), "a")), "heights are numbers"),
    "pickle.npy": (_array(np.full((9, 9), print, object), allow_pickle=True), "damaged or cut short: "),
    "color.png": (lambda path: Image.new("RGB", (50, 50), "red").save(path), "a colour picture"),
    "map.yaml": (lambda path: path.write_text("image: map.pgm"), "is a map of where walls are"),
    "deep.png": (lambda path: _png_header(path, 50, 50, 16, 2), "colours of 16 bits (gdal_translate"),
    "bands.tif": (_tiff(np.zeros((64, 64, 3), np.uint8), photometric="rgb"), "it has 3 bands"),
    "palette.tif": (
        _tiff(
            np.zeros((64, 64), np.uint8), photometric="palette", colormap=np.zeros((3, 256), np.uint16)
        ),
        "its values are numbers of colours",
    ),
    "photo-cd.png": (
        lambda path: path.write_bytes(b"\x89PNG".ljust(2048) + b"PCD_".ljust(2048)),
        "damaged or cut short",
    ),
    "jpeg.tif": (lambda path: _patched(path, {"Compression": 7}), "with JPEG compression are not read"),
    "tile.tif": (_tile, "pixels are too many"),
    "5-bit.tif": (
        lambda path: _patched(path, {"BitsPerSample": 5}),
        "None values with NONE compression",
    ),
    "unit.tif": (_tiff(PICTURE), "does not say that its values are metres; give --terrain-height"),
    "deep.npy": (_array(np.linspace(0, 10_001, 1681).reshape(41, 41)), "its relief is 10001 m"),
    "steep.npy": (_array(STEEP), "the gentlest place is 45 deg steep"),
    "unknown-size.npy": (_array(hills()), "does not say how large it is; give --terrain-size"),
    "unknown-degrees.tif": (
        lambda path: write_geotiff(path, hills(), 1e-5, model_type=2),
        "pixels are degrees (gdalwarp",
    ),
    "unknown-narrow.tif": (_mapped(9.0, 20.0), "it is 9 x 20 m; between 10 and 50000 m"),
    "unknown-low.tif": (_mapped(20.0, 9.0), "it is 20 x 9 m; between 10 and 50000 m"),
    "unknown-wide.tif": (_mapped(6e4, 20.0), "it is 60000 x 20 m; between 10 and 50000 m"),
}


@pytest.mark.parametrize("name", BAD)
def test_a_bad_file_is_one_line_that_names_it(
    name: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Nor does a decoder say anything beside it."""
    make, expected = BAD[name]
    make(path := tmp_path / name)
    logging.getLogger("tifffile").setLevel(logging.NOTSET)
    with pytest.raises(UsageError) as caught:
        world_of(path, terrain_size=None if name.startswith("unknown") else 20.0)
    message = str(caught.value)
    assert expected in message
    assert str(path) in message
    assert "\n" not in message
    assert caplog.records == []


@pytest.mark.parametrize("mode", ["RGB", "RGBA", "LA", "P"])
def test_a_picture_of_colours_that_are_all_grey_is_one_of_heights(tmp_path: Path, mode: str) -> None:
    heights = np.arange(144, dtype=np.uint8).reshape(12, 12)
    Image.fromarray(heights).convert(mode).save(tmp_path / "a.png")
    np.testing.assert_array_equal(read_raster(tmp_path / "a.png").values, heights)


def test_what_is_transparent_in_a_picture_is_missing(tmp_path: Path) -> None:
    heights, alpha = np.full((12, 12), 7, np.uint8), np.full((12, 12), 255, np.uint8)
    alpha[:2] = 0
    Image.fromarray(np.dstack([heights, alpha])).save(tmp_path / "a.png")
    assert np.isnan(read_raster(tmp_path / "a.png").values).sum() == 24
    for kind in (np.uint8, np.uint16):
        grey = Image.fromarray(np.arange(144, dtype=kind).reshape(12, 12))
        grey.save(tmp_path / "grey.png", transparency=100)
        assert np.argwhere(np.isnan(read_raster(tmp_path / "grey.png").values)).tolist() == [[8, 4]]
