"""ESRI's grids in text (.asc): keys with numbers, then heights; a .prj beside one tells its units."""

import codecs
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from harness.base.errors import UsageError
from harness.world.heightfield import Field
from harness.world.heightmap.geotiff import MOST_DEGREES, NAMED_OF_THE_GLOBE, SIZE_UNKNOWN
from harness.world.heightmap.units import MERCATORS, NAMED, WKT_VERTICAL, wkt_units
from rover_metrics.number import number

BEGINS = (b"ncols", b"nrows", b"xllco", b"yllco", b"xllce", b"yllce", b"cells")
KEY = re.compile(
    r"\s*(ncols|nrows|[xy]ll(?:corner|center)|cellsize|d[xy]|nodata_value)\s+(\S+)", re.IGNORECASE
)
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?|[-+]?(nan|inf)", re.IGNORECASE)
NODATA = -9999.0  # ESRI's default
OLD_UNIT = re.compile(r"^\s*units\s+(\S+)", re.IGNORECASE | re.MULTILINE)  # of ARC/INFO, before WKT
STRETCHED = (
    "its map's metres are not the ground's (gdalwarp -t_srs EPSG:..., of a UTM zone, gives those)"
)
OF_THE_GLOBE = re.compile(
    r'PROJECTION\["(Plate_Carree|Equidistant_Cyl|Equirect|Sinusoidal|Robinson|Cylindrical_Equal|Miller)'
)
MOST_SHOWN = 20  # letters of what is no number
DEGREES = "its cells are degrees (gdalwarp -t_srs EPSG:... gives metres)"


def is_esri(start: bytes) -> bool:
    """Returns whether a file that begins so is such a grid."""
    return start.removeprefix(codecs.BOM_UTF8).lstrip()[:5].lower() in BEGINS


def read_grid_in_text(
    path: Path, check_size: Callable[[int, int], None]
) -> tuple[Field, tuple[float, float] | str, bool]:
    """Returns heights, the northern row first, their distance [m] or why it is unknown, and if in m.

    Args:
        path: The grid's.
        check_size: Is given columns and rows before the heights are read.

    Raises:
        UsageError: There are more or fewer heights than it says, or they are depths or no numbers.
        ValueError: Its keys are damaged.
    """
    content, at, header = path.read_bytes().removeprefix(codecs.BOM_UTF8), 0, {}
    text = content.decode("ascii", "replace").replace(",", ".")
    while (match := KEY.match(text, at)) is not None:
        header[match[1].lower()], at = number(match[2]), match.end()
    if lacks := [key for key in ("ncols", "nrows") if key not in header]:
        raise UsageError(f"its header has no {lacks[0]} with a number")
    rows, columns = int(header["nrows"]), int(header["ncols"])
    check_size(columns, rows)
    values = _numbers(text[at:])
    if values.size != rows * columns:
        raise UsageError(f"it has {values.size} heights, not {columns} x {rows}; is it whole?")
    values[values == header.get("nodata_value", NODATA)] = np.nan
    values = values.reshape(rows, columns)
    width, depth = (header.get(key, header.get("cellsize", np.nan)) for key in ("dx", "dy"))
    crs = path.with_suffix(".prj")
    said = crs.read_text("utf-8", "replace") if crs.is_file() else ""
    if not min(width, depth) > 0.0:
        return values, SIZE_UNKNOWN, True
    old = OLD_UNIT.search(said)
    if any(kind.search(said) for kind in (MERCATORS, NAMED_OF_THE_GLOBE, OF_THE_GLOBE)):
        return values, STRETCHED, True
    if (
        said.startswith(("GEOG", "GEOD"))
        or (old and old[1].upper() == "DD")
        or max(width, depth) < MOST_DEGREES
    ):
        return values, DEGREES, True
    ground, height = wkt_units(said) if old is None else (NAMED.get(old[1].lower(), np.nan), 1.0)
    if np.isnan(ground):
        return values, SIZE_UNKNOWN, True
    in_metres = ground == 1.0 or WKT_VERTICAL.search(said) is not None
    return values * (height if in_metres else 1.0), (width * ground, depth * ground), in_metres


def _numbers(text: str) -> Field:
    try:
        return np.fromstring(text, sep=" ")
    except ValueError:
        odd = next((word for word in text.split() if not NUMBER.fullmatch(word)), "")[:MOST_SHOWN]
        raise UsageError(
            f"'{odd}' is no height; give numbers apart by blanks, and no comments"
        ) from None
