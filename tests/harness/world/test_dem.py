import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tifffile
from numpy.typing import NDArray
from PIL import Image

from harness.errors import UsageError
from harness.world.dem import TerrainFile, file_world, is_terrain_file
from harness.world.raster import read_raster
from harness.world.regrid import filled, resampled
from harness.world.statistics import slopes
from harness.world.world import World, terrain_hash

MARSYARD = Path(__file__).parents[4] / "shared/data/marsyard/marsyard2021_terrain_hm.tif"
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


def write_geotiff(path: Path, values: NDArray[np.generic], pixel: float, model_type: int = 1) -> Path:
    keys = (1, 1, 0, 1, 1024, 0, 1, model_type)
    tags = [
        (PIXEL_SCALE, "d", 3, (pixel, pixel, 0.0), True),
        (TIE_POINT, "d", 6, (0.0, 0.0, 0.0, 500.0, 900.0, 0.0), True),
        (GEO_KEYS, "H", len(keys), keys, True),
    ]
    tifffile.imwrite(path, values, extratags=tags)
    return path


@needs_marsyard
def test_the_marsyard_dem_is_driven_as_it_was_measured() -> None:
    world = file_world(TerrainFile(path=MARSYARD), 0)
    heights, count = world.ground.heights[::-1], len(world.ground.heights)
    assert world.ground.cell == pytest.approx(0.094)
    raw = tifffile.imread(MARSYARD)
    windows = [
        raw[row : row + count, column : column + count]
        for row in range(len(raw) - count + 1)
        for column in range(len(raw) - count + 1)
    ]
    assert any(np.allclose(heights, window - window.min(), atol=2e-6) for window in windows)
    p50, p95 = np.percentile(slopes(world.ground), (50, 95))
    assert p50 == pytest.approx(13.0, abs=1.0)
    assert p95 == pytest.approx(40.5, abs=2.0)  # of the whole: the start moves off the middle


@needs_marsyard
def test_rovers_start_beside_the_mound_in_the_middle_of_the_marsyard() -> None:
    world = file_world(TerrainFile(path=MARSYARD), 0)
    (note,) = world.notes
    assert note == "starts 0.8 m off its middle, on gentle ground; 45.31 m remain"
    middle = len(world.ground.heights) // 2
    assert slopes(world.ground)[middle - 3 : middle + 4, middle - 3 : middle + 4].max() < 15.0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("compression", [None, "zlib"])
def test_float_tiff_is_read_in_metres(tmp_path: Path, dtype: type, compression: str | None) -> None:
    tifffile.imwrite(tmp_path / "a.tif", hills().astype(dtype), compression=compression)
    heights = world_of(tmp_path / "a.tif").ground.heights
    np.testing.assert_allclose(heights[::-1], hills() - hills().min(), atol=2e-6)


def test_lzw_is_unpacked_by_libtiff(tmp_path: Path) -> None:
    Image.fromarray(hills()).save(tmp_path / "a.tif", compression="tiff_lzw")
    heights = world_of(tmp_path / "a.tif").ground.heights
    np.testing.assert_allclose(heights[::-1], hills() - hills().min(), atol=2e-6)


@pytest.mark.parametrize(("dtype", "step"), [(np.uint8, 1 / 255), (np.uint16, 1 / 65535)])
def test_png_is_scaled_to_the_relief(tmp_path: Path, dtype: type, step: float) -> None:
    unit = (hills() - hills().min()) / np.ptp(hills())
    Image.fromarray((unit * np.iinfo(dtype).max).astype(dtype)).save(tmp_path / "a.png")
    world = world_of(tmp_path / "a.png", relief=0.5)
    np.testing.assert_allclose(world.ground.heights[::-1], 0.5 * unit, atol=step)
    assert "scaled to 0.5 m of relief" in world.notes[0]


def test_first_row_of_a_file_is_the_north_edge(tmp_path: Path) -> None:
    values = np.zeros((51, 51))
    values[0, -1] = 1.0
    ground = world_of(saved(tmp_path / "a.npy", values)).ground
    assert ground.height_at(10.0, 10.0) == 1.0
    assert ground.height_at(10.0, -10.0) == 0.0


def test_georeference_gives_the_size_and_the_flag_overrides_it(tmp_path: Path) -> None:
    path = write_geotiff(tmp_path / "a.tif", hills(), 0.2)
    assert world_of(path, size=None).ground.half_size == pytest.approx(10.0)
    assert world_of(path, size=30.0).ground.half_size == pytest.approx(15.0)


def test_degrees_need_a_size(tmp_path: Path) -> None:
    path = write_geotiff(tmp_path / "a.tif", hills(), 1e-5, model_type=2)
    with pytest.raises(UsageError, match=r"pixels are degrees .*; give --terrain-size"):
        world_of(path, size=None)
    assert world_of(path).ground.half_size == pytest.approx(10.0)


def test_gdal_nodata_and_nan_are_filled_and_reported(tmp_path: Path) -> None:
    values = hills()
    values[10:15, 20:25] = -9999.0
    values[70, 70] = np.nan
    tifffile.imwrite(tmp_path / "a.tif", values, extratags=[(42113, "s", 0, "-9999", True)])
    world = world_of(tmp_path / "a.tif")
    assert world.notes == ("26 missing heights (0.25%) filled from their surroundings",)
    np.testing.assert_allclose(world.ground.heights[::-1], hills() - hills().min(), atol=0.05)


def test_filling_keeps_what_is_known_and_a_plane_nearly_plane() -> None:
    y, x = np.mgrid[0:40, 0:57]
    plane = 0.1 * x + 0.05 * y
    holed = plane.copy()
    holed[5:12, 30:37] = np.nan
    known = ~np.isnan(holed)
    np.testing.assert_array_equal(filled(holed)[known], plane[known])
    np.testing.assert_allclose(filled(holed), plane, atol=0.25)


def test_resampling_keeps_a_plane_and_evens_out_what_cells_cannot_show() -> None:
    y, x = np.mgrid[0:61, 0:61].astype(float)
    inner = slice(3, -3)
    coarse = resampled(2.0 * x - y, (3.0, 3.0), 21)
    np.testing.assert_allclose(coarse[inner, inner], (2.0 * x - y)[::3, ::3][inner, inner])
    checks = resampled((-1.0) ** (x + y), (3.0, 3.0), 21)
    assert np.abs(checks).max() < 0.2


def test_fine_pixels_become_cells_of_5_cm(tmp_path: Path) -> None:
    world = world_of(saved(tmp_path / "a.npy", hills(1001, 1001) * 0.02))
    assert world.ground.cell == 0.05
    assert "pixels of 0.02 x 0.02 m resampled to cells of 0.05 m" in world.notes[0]


def test_huge_maps_are_kept_to_what_memory_holds(tmp_path: Path) -> None:
    world = world_of(saved(tmp_path / "a.npy", np.zeros((1800, 1800), np.float32)), size=1799.0)
    assert len(world.ground.heights) == 1500
    assert world.ground.half_size == pytest.approx(899.5)


def test_oblong_map_is_cropped_to_its_middle_square(tmp_path: Path) -> None:
    values = np.tile(0.01 * np.arange(201.0), (101, 1))
    path = write_geotiff(tmp_path / "a.tif", values, 0.2)
    world = world_of(path, size=None)
    assert world.ground.half_size == pytest.approx(10.0)
    assert np.ptp(world.ground.heights) == pytest.approx(1.0)
    assert world.notes == ("40 x 20 m cropped to the middle 20 m",)


def test_start_moves_to_gentle_ground_near_the_middle(tmp_path: Path) -> None:
    y, x = np.mgrid[0:101, 0:101]
    cone = np.maximum(0.0, 2.0 - 0.2 * np.hypot(x - 50, y - 50))  # 45 deg within 2 m of the middle
    world = world_of(saved(tmp_path / "a.npy", cone))
    around = [world.ground.height_at(x, y) for x in (-0.4, 0.4) for y in (-0.4, 0.4)]
    assert np.ptp(around) < 0.2
    assert world.ground.half_size < 8.0
    assert "off its middle, on gentle ground" in world.notes[0]


def test_dem_on_which_no_rover_can_stand_is_refused(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npy", np.tile(0.2 * np.arange(101.0), (101, 1)))
    with pytest.raises(UsageError, match=r"no rover can stand within 5\.05 m .* 45 deg steep"):
        world_of(path)


def test_the_same_file_gives_the_same_hash(tmp_path: Path) -> None:
    path = saved(tmp_path / "a.npy", hills())
    other = saved(tmp_path / "b.npy", hills() * 1.01)
    assert terrain_hash(world_of(path)) == terrain_hash(world_of(path))
    assert terrain_hash(world_of(path)) != terrain_hash(world_of(other))


@pytest.mark.parametrize(
    ("name", "expected"),
    [("rocky", False), ("moon", False), ("moon.tif", True), ("x/moon", True), ("A.PNG", True)],
)
def test_names_with_a_known_ending_or_a_folder_are_files(name: str, expected: bool) -> None:
    assert is_terrain_file(name) is expected


def _nothing(_: Path) -> None:
    """Leaves the file missing."""


def _huge_npy(path: Path) -> None:
    with path.open("wb") as file:
        header = {"descr": "<f4", "fortran_order": False, "shape": (10000, 10000)}
        np.lib.format.write_array_header_1_0(file, header)
        file.truncate(400_000_200)  # sparse: takes no room


def _bomb(path: Path) -> None:
    tifffile.imwrite(path, np.zeros((64, 64)), compression="zlib", rowsperstrip=64)
    with tifffile.TiffFile(path) as file:
        tags = file.pages.first.tags
        fields = [tags[name].valueoffset for name in ("StripOffsets", "StripByteCounts")]
    data = bytearray(path.read_bytes())
    bomb = zlib.compress(bytes(20_000_000), 9)
    for field, value in zip(fields, (len(data), len(bomb)), strict=True):
        data[field : field + 4] = value.to_bytes(4, "little")
    path.write_bytes(bytes(data) + bomb)


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
    "missing.tif": (_nothing, "No such file"),
    "folder.tif": (lambda path: path.mkdir(), "Is a directory"),
    "empty.tif": (lambda path: path.touch(), "is empty"),
    "text.tif": (
        lambda path: path.write_text("x,y,z\n1,2,3\n"),
        "is not a heightmap; readable are",
    ),
    "cut.tif": (_cut, "damaged or cut short"),
    "cut.png": (_cut, "damaged or cut short"),
    "cut.npy": (_cut, "damaged or cut short"),
    "noise.tif": (_noise, "noise.tif"),
    "noise.png": (_noise, "damaged or cut short"),
    "noise.npy": (_noise, "damaged or cut short"),
    "bomb.tif": (_bomb, "unpacks to more than its size"),
    "bomb.png": (lambda path: Image.new("1", (30000, 30000)).save(path), "too many pixels"),
    "huge.png": (
        lambda path: Image.new("L", (12500, 8000)).save(path),
        "x 8000 pixels are too many",
    ),
    "huge.npy": (_huge_npy, "10000 x 10000 pixels are too many"),
    "one.npy": (lambda path: np.save(path, np.zeros((1, 1))), "1 x 1 pixels are too few"),
    "nan.npy": (lambda path: np.save(path, np.full((50, 50), np.nan)), "holds no height at all"),
    "half.npy": (lambda path: np.save(path, np.pad(hills(), 60, constant_values=np.nan)), "are missing"),
    "cube.npy": (lambda path: np.save(path, np.zeros((9, 9, 9))), "a heightmap has 2"),
    "text.npy": (lambda path: np.save(path, np.full((9, 9), "a")), "heights are numbers"),
    "color.png": (lambda path: Image.new("RGB", (50, 50)).save(path), "a colour picture"),
    "bands.tif": (_bands, "has one band"),
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


@pytest.mark.parametrize(("size", "relief"), [(0.0, 1.0), (-5.0, 1.0), (1e9, 1.0), (20.0, -1.0)])
def test_impossible_sizes_are_refused(tmp_path: Path, size: float, relief: float) -> None:
    file = TerrainFile(path=saved(tmp_path / "a.npy", hills()), size=(size, size), relief=relief)
    with pytest.raises(UsageError, match="is not valid; give"):
        file_world(file, 0)
