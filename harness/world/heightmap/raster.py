"""Heights from a file: TIFF and GeoTIFF, PNG, .npy, ESRI's .asc, told apart by how they begin; clouds.

Nothing in a file is trusted: sizes are checked before anything is decoded, pickles are never loaded. A
raster's first row is the north edge (largest y), its first column the west edge, as in every image.
"""

import logging
import re
import warnings
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import tifffile
from PIL import Image

from harness.base.documents import FETCH, LFS, POINTER, read_bytes
from harness.base.errors import UsageError, told
from harness.world.heightfield import Field
from harness.world.heightmap.cloud import SUFFIXES, gridded, is_cloud, read_points
from harness.world.heightmap.esri import is_esri, read_grid_in_text
from harness.world.heightmap.geotiff import SIZE_UNKNOWN, read_grid
from harness.world.heightmap.packed import READABLE, unpacked
from harness.world.heightmap.units import NAMED
from rover_metrics.errors import reason_of
from rover_metrics.number import number

MOST_PIXELS = 4096 * 4096  # 128 MiB as float64
MOST_BYTES = 2**28  # of a file: twice what the most pixels of 64 bits take
MOST_BESIDE = 2**24  # of what GDAL wrote beside it: histograms may be long
MOST_HEADER = 10_000  # bytes of an array's header: numpy's own bound, which it asks too late
FEWEST_PIXELS = 8  # along either side
LARGEST_HEIGHT = 20_000.0  # [m]; beyond it a value marks missing data
UNTAGGED = -9999.0  # [m]: marks it too, even if no tag says so
METADATA_TAG, NODATA_TAG = 42112, 42113  # GDAL's
FORMATS = {b"\x93NUMPY": "npy", b"\x89PNG": "png", b"II": "tiff", b"MM": "tiff"}
GREY_MODES = ("1", "L", "I", "F")  # Pillow's, beside those of 16 bits
MAPS = (".yaml", ".yml", ".pgm")  # of ROS
REWRITE = "gdal_translate -ot Float32 -co COMPRESS=NONE rewrites it"


@dataclass(frozen=True, eq=False)
class Raster:
    """What a file holds."""

    values: Field  # shape (rows, columns), NaN where there are none
    # distance of two columns and of two rows [m]; or why it is unknown, as a sentence starts
    pixel: tuple[float, float] | str
    in_metres: bool  # whether the values are heights in metres; else they only are proportional to them
    notes: tuple[str, ...] = ()  # what its file says of it that a reader should know


def read_raster(path: Path, cell: float | None = None) -> Raster:
    """Reads a file of any format; UsageError if it is missing, too large, damaged or no heightmap.

    The heights that a cloud of points becomes are `cell` metres apart; None chooses it.
    """
    kind = _kind(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # as of tifffile's log below
            if is_cloud(path):
                raster = _of_cloud(path, cell)
            else:
                readers = {"npy": _read_npy, "png": _read_png, "tiff": _read_tiff, "esri": _read_esri}
                raster = readers[kind](path)
    except ImportError as error:
        reason = f"LAS and LAZ need laspy; pip install '.[cloud]' ({error})"
        raise UsageError(f"terrain {path}: {reason}") from error
    except UsageError as error:
        raise UsageError(f"terrain {path}: {error}") from error
    except Exception as error:  # decoders raise anything at all over a damaged file
        raise UsageError(f"terrain {path} is damaged or cut short: {told(error)}") from error
    largest = LARGEST_HEIGHT if raster.in_metres else np.inf
    missing = ~np.isfinite(raster.values) | (np.abs(raster.values) > largest)
    missing |= raster.in_metres & (raster.values == UNTAGGED)
    raster.values[missing] = np.nan
    if missing.all():
        raise UsageError(
            f"terrain {path} holds no height at all: every value is NaN, no-data or beyond 20 km"
        )
    return raster


def _begin(path: Path) -> bytes:
    """The first bytes of a file that can be one; else UsageError."""
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):
            raise UsageError(f"terrain {path} is not a file")
        with path.open("rb") as file:
            begin, size = file.read(len(LFS)), path.stat().st_size
    except (OSError, ValueError) as error:
        raise UsageError(f"terrain {path} cannot be read: {reason_of(error)}") from error
    if not begin:
        raise UsageError(f"terrain {path} is empty")
    if begin == LFS:
        raise UsageError(f"terrain {path} {POINTER}; {FETCH}")
    if size > MOST_BYTES:
        raise UsageError(
            f"terrain {path} is larger than {MOST_BYTES >> 20} MiB; crop it (gdal_translate -srcwin)"
        )
    return begin


def _kind(path: Path) -> str:
    start = _begin(path)[:12]
    if (
        start.startswith(b"\x93NUMPY")
        and start[6] > 1
        and int.from_bytes(start[8:], "little") > MOST_HEADER
    ):
        raise UsageError(f"terrain {path} is damaged: the header of an array is not that long")
    if path.suffix.lower() in SUFFIXES:
        return "cloud"
    for magic, kind in FORMATS.items():
        if start.startswith(magic):
            return kind
    if is_esri(start):
        return "esri"
    if path.suffix.lower() in MAPS:
        raise UsageError(
            f"terrain {path} is a map of where walls are, not of heights, if map_server reads it; make "
            "the walls boxes of an SDF world"
        )
    raise UsageError(
        f"terrain {path} is not a heightmap; readable: TIFF, PNG, .npy, .asc, PLY, LAS, LAZ, meshes as "
        ".obj, .stl, .dae, .ply; gdal_translate IN OUT.tif makes a TIFF of other grids (.hgt, .xyz), "
        "pdal translate IN OUT.las LAS of other clouds"
    )


def _of_cloud(path: Path, cell: float | None) -> Raster:
    points, units = read_points(path)
    heights, cell, notes = gridded(points, cell)
    _check_size(heights.shape[1], heights.shape[0])
    return Raster(heights, (cell, cell), True, (*units, *notes))


def _check_size(columns: int, rows: int, fewest: int = FEWEST_PIXELS) -> None:
    if columns * rows > MOST_PIXELS:
        raise UsageError(
            f"{columns} x {rows} pixels are too many; at most {MOST_PIXELS / 1e6:.0f} million are read: "
            "give a part (gdal_translate -srcwin), or coarser ones (-outsize, --terrain-cell of a cloud)"
        )
    if min(columns, rows) < fewest:
        raise UsageError(
            f"{columns} x {rows} pixels are too few; a side needs {fewest} or more, a cloud of points "
            "three columns"
        )


def _read_npy(path: Path) -> Raster:
    array = np.load(path, mmap_mode="r", allow_pickle=False)  # maps: nothing is read yet
    if array.ndim != 2:
        raise UsageError(f"the array has {array.ndim} dimensions; a heightmap has 2")
    _check_size(array.shape[1], array.shape[0])
    if array.dtype.kind not in "fiu":
        raise UsageError(f"its values are {array.dtype}; heights are numbers")
    return Raster(array.astype(np.float64), SIZE_UNKNOWN, array.dtype.kind == "f")


def _read_esri(path: Path) -> Raster:
    return Raster(*read_grid_in_text(path, _check_size))


def _read_png(path: Path) -> Raster:
    try:
        image = Image.open(path, formats=("PNG",))
    except Image.DecompressionBombError as error:
        raise UsageError(f"too many pixels; at most {MOST_PIXELS / 1e6:.0f} million are read") from error
    with image:
        _check_size(*image.size)
        is_grey = image.mode in GREY_MODES or image.mode.startswith("I;16")
        if not is_grey and "16" in str(image.tile[0][3]):  # of which Pillow would keep 8
            raise UsageError("colours of 16 bits (gdal_translate -b 1 takes the first, of all its bits)")
        pixels = np.asarray(image)
        if not is_grey:
            pixels = np.asarray(image.convert("RGB"))
            if (pixels != pixels[..., :1]).any():
                raise UsageError(f"a colour picture ({image.mode}), not a heightmap; convert it to grey")
            pixels = pixels[..., 0]
        values = pixels.astype(np.float64)
        clear = image.info.get("transparency")  # what is transparent is not there
        if not is_grey:
            values[np.asarray(image.convert("RGBA").getchannel("A")) == 0] = np.nan
        elif clear is not None:
            values[values == clear] = np.nan
        return Raster(values, SIZE_UNKNOWN, in_metres=False)


def _read_tiff(path: Path) -> Raster:
    logging.getLogger("tifffile").setLevel(logging.CRITICAL)  # a file's flaws are one line, or nothing
    with tifffile.TiffFile(path) as file:
        page = file.pages.first
        _check_page(page)
        values, grid = _tiff_values(page), read_grid(page)
        said = f"{page.tags.valueof(METADATA_TAG)}{_beside(path)}"
        nodata = page.tags.valueof(NODATA_TAG) or _gdal_text(said, "NoDataValue")
        scale, offset = (_gdal_number(said, role) for role in ("scale", "offset"))
        unit_type = _gdal_text(said, "unittype").strip()
        is_float = page.dtype is not None and page.dtype.kind == "f"
        for mask in file.pages:  # overviews have their own
            if isinstance(mask, tifffile.TiffPage) and mask.is_mask and mask.shape == values.shape:
                values[mask.asarray() == 0] = np.nan
    if (beside := path.with_name(f"{path.name}.msk")).is_file():
        with tifffile.TiffFile(beside) as file:
            if file.pages.first.shape == values.shape:
                values[_tiff_values(file.pages.first) == 0] = np.nan
    if nodata:
        values[np.isclose(values, number(str(nodata)), rtol=1e-6, atol=0.0)] = np.nan
    if is_scaled := (scale, offset) != (None, None):
        scale, offset = 1.0 if scale is None else scale, offset or 0.0
        values = values * scale + offset
        note = f"its heights are {scale:g} of what it stores, plus {offset:g}, as its tag says"
        grid = replace(grid, notes=(*grid.notes, note))
    unit = 1.0 if (is_float or is_scaled) and isinstance(grid.pixel, str) else grid.height_unit
    if unit_type:
        unit = NAMED.get(unit_type.casefold())
        if unit != 1.0:
            note = f"its heights are in {unit_type}, as its tag says"
            grid = replace(grid, notes=(*grid.notes, note))
    values = grid.north_up(values) * (1.0 if unit is None else unit)
    return Raster(values, grid.pixel, unit is not None, grid.notes)


def _check_page(page: tifffile.TiffPage) -> None:
    if len(page.shape) != 2:
        raise UsageError(
            f"it has {page.samplesperpixel} bands; a heightmap has one "
            "(gdal_translate -b 1 takes the first)"
        )
    if page.photometric == tifffile.PHOTOMETRIC.PALETTE:
        raise UsageError("its values are numbers of colours (gdal_translate -expand gray mends grey)")
    _check_size(page.shape[1], page.shape[0])


def _beside(path: Path) -> str:
    """What GDAL wrote beside a file where it was not to write into it; "" if there is nothing."""
    file = path.with_name(f"{path.name}.aux.xml")
    return read_bytes(file, MOST_BESIDE).decode(errors="replace") if file.is_file() else ""


def _gdal_number(said: str, role: str) -> float | None:
    """The number in an item of GDAL's metadata; None if there is no such item."""
    text = _gdal_text(said, role)
    return number(text) if text else None


def _gdal_text(said: str, role: str) -> str:
    """The text of an item of GDAL's metadata, in the file or beside it; "" if there is no such item."""
    match = re.search(rf'(?:role="{role}"[^>]*|<{role}(?: [^>]*)?)>([^<]*)<', said, re.IGNORECASE)
    return match[1] if match else ""


def _tiff_values(page: tifffile.TiffPage) -> Field:
    if page.dtype is not None and page.dtype.kind in "fiu" and page.bitspersample % 8 == 0:
        if page.compression == tifffile.COMPRESSION.NONE:
            return page.asarray().astype(np.float64)
        if page.compression in READABLE:
            height, width = page.chunks
            _check_size(width, height, fewest=1)
            return unpacked(page).astype(np.float64)
    compression = tifffile.COMPRESSION(page.compression).name
    raise UsageError(f"{page.dtype} values with {compression} compression are not read; {REWRITE}")
