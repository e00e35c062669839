"""Where the pixels of a GeoTIFF lie, by its tags: how large they are, which way is east, which north.

ModelPixelScale with a tie point or ModelTransformation places them, whether there are GeoKeys or not;
those name the units (OGC GeoTIFF 1.1). Without them the unit is taken to be the metre.
"""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tifffile
from numpy.typing import NDArray
from pymap3d import Ellipsoid, rcurve
from pymap3d.latitude import isometric2geodetic

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.world.heightmap.units import METRE, UNITS, height_unit, horizontal_unit
from rover_metrics.number import number

PIXEL_SCALE, TIE_POINTS, TRANSFORMATION = 33550, 33922, 34264  # tags
GEOGRAPHIC, GEOCENTRIC = 2, 3  # model types
PIXEL_IS_POINT = 2  # raster type: the tie point is the middle of a pixel, not its corner
DEGREE = 9102
WEB_MERCATOR = (3857, 3785)  # EPSG's numbers
MERCATOR, EQUIRECTANGULAR, WEB = 7, 17, 0  # TIFF's numbers of projections, but for the last
CYLINDERS = {  # by EPSG's numbers
    3395: MERCATOR,
    **dict.fromkeys((4087, 4088, 32662), EQUIRECTANGULAR),
    **dict.fromkeys(WEB_MERCATOR, WEB),
}
SINUSOIDAL = 24
OF_THE_GLOBE = (20, 23, 25, 28)  # Miller's, Robinson's, Van der Grinten's, cylindrical of equal areas
EQUAL_AREAS = (6933, 3410, 3975, 8857, 8858, 8859)  # EPSG's numbers of the last kind, and Equal Earth
# Those without a number of TIFF's, as GDAL names them.
NAMED_OF_THE_GLOBE = re.compile(
    r'PROJECTION\["(Mollweide|Eckert|Goode|Winkel|Wagner|Equal_Earth|Natural_Earth|Aitoff|Hammer|Gall)'
)
AZIMUTHAL, MOST_SQUEEZE = 10, 0.01  # Lambert's, of equal areas; how much longer one way than it is
CALLED = {MERCATOR: "Mercator's", EQUIRECTANGULAR: "equirectangular", WEB: "Web Mercator's"}
STEREOGRAPHIC, POLAR = 15, {3413: 70.0, 3031: 71.0, 3995: 71.0, 3976: 70.0}  # EPSG's: true at latitude
# What GeoKeys would say of CRSs that files name by EPSG's number alone: of Mercator's and polar ones.
UPS = {"ProjCoordTransGeoKey": 15, "ProjScaleAtNatOriginGeoKey": 0.994,
       "ProjFalseEastingGeoKey": 2e6, "ProjFalseNorthingGeoKey": 2e6}  # fmt: skip
OF_A_POLE = {"ProjCoordTransGeoKey": 10}
PARAMETERS: Mapping[int, Mapping[str, Any]] = {
    3349: {"ProjCoordTransGeoKey": 7},
    3832: {"ProjCoordTransGeoKey": 7},
    3388: {"ProjCoordTransGeoKey": 7, "ProjStdParallel1GeoKey": 42.0},
    3994: {"ProjCoordTransGeoKey": 7, "ProjStdParallel1GeoKey": -41.0},
    5641: {"ProjCoordTransGeoKey": 7, "ProjStdParallel1GeoKey": -2.0, "ProjFalseNorthingGeoKey": 1e7},
    3996: {"ProjCoordTransGeoKey": 15, "ProjNatOriginLatGeoKey": 75.0},
    9354: {"ProjCoordTransGeoKey": 15, "ProjNatOriginLatGeoKey": 65.0},
    **dict.fromkeys((5041, 5042, *range(5936, 5941), 32661, 32761), UPS),
    **dict.fromkeys((*range(3571, 3577), 3408, 3409, 6931, 6932), OF_A_POLE),
}
LEAST_STRETCH = 1e-3  # of such metres that counts
WGS84 = Ellipsoid.from_name("wgs84")
NEAREST_POLE = 85.0  # [deg] of latitude, up to which degrees are made metres
MOST_DEGREES = 1e-3  # of a pixel, if nothing says what its unit is: metres so small are no ground
MOST_SKEW = math.radians(0.5)  # of rows and columns that count as at right angles
SMALLEST_TURN = 0.05  # [deg] that is noted
WORLD_FILES, LARGEST_WORLD_FILE = (".tfw", ".tifw", ".wld", ".TFW"), 4096  # [bytes]
SQUEEZED = "its map squeezes the ground (gdalwarp -t_srs EPSG:..., of a UTM zone, gives metres)"
SIZE_UNKNOWN = "it does not say how large it is"
Affine = NDArray[np.float64]  # (2, 3): columns, rows, 1 -> coordinates


@dataclass(frozen=True, eq=False)
class Grid:
    """The pixels of a file in the world."""

    # distance of two columns and of two rows, once north is up [m]; or why it is unknown, as a sentence
    # starts
    pixel: tuple[float, float] | str = SIZE_UNKNOWN
    # of the values [m]; None if the file does not place its pixels or does not say
    height_unit: float | None = None
    # whether what it stores as rows are columns; then `mirrored`, whether these run west, and
    # `upside_down`, whether rows run north
    transposed: bool = False
    mirrored: bool = False
    upside_down: bool = False
    notes: tuple[str, ...] = ()  # what of this a reader should know

    def north_up(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Returns the pixels with the first row in the north and the first column in the west."""
        values = values.T if self.transposed else values
        return values[:: -1 if self.upside_down else 1, :: -1 if self.mirrored else 1]


def read_grid(page: tifffile.TiffPage) -> Grid:
    """Returns what the tags of a page say; UsageError if rows and columns are not at right angles."""
    keys = spelled_out(page.geotiff_tags or {})
    affine = _affine(page)
    if not keys and _are_degrees(affine):
        keys = {"GTModelTypeGeoKey": GEOGRAPHIC}
    if keys.get("GTModelTypeGeoKey") == GEOGRAPHIC:
        return _projected(affine, keys, page)
    if keys.get("GTModelTypeGeoKey") == GEOCENTRIC:
        return Grid("its coordinates are geocentric (gdalwarp -t_srs EPSG:... gives metres)")
    if affine is not None and (unrolled := _unrolled(affine, keys, page)) is not None:
        return _projected(unrolled[0], keys, page, unrolled[1])
    number = horizontal_unit(keys)
    if number not in UNITS:
        return Grid(f"its unit {number} is not known (gdalwarp -t_srs EPSG:... gives metres)")
    if affine is None:
        return Grid()
    return _placed(affine, keys, page)


def spelled_out(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Returns GeoKeys with those that the number of their CRS stands for."""
    return {**PARAMETERS.get(keys.get("ProjectedCSTypeGeoKey", 0), {}), **keys}


def _are_degrees(affine: Affine | None) -> bool:
    """Whether coordinates that no key explains are longitudes and latitudes."""
    if affine is None or np.abs(affine[:, :2]).max() > MOST_DEGREES:
        return False
    return bool((np.abs(affine[:, 2]) <= (180.0, NEAREST_POLE)).all())


def _projected(
    affine: Affine | None, keys: Mapping[str, Any], page: tifffile.TiffPage, what: str = "degrees"
) -> Grid:
    """Degrees as metres along the meridian and the parallel of the middle."""
    unit = keys.get("GeogAngularUnitsGeoKey", DEGREE)
    middle = None if affine is None else affine @ _half(keys, page)
    if affine is None or middle is None or unit != DEGREE or abs(middle[1]) > NEAREST_POLE:
        return Grid(f"its pixels are {what} (gdalwarp -t_srs EPSG:... gives metres)", 1.0)
    body = _ellipsoid(keys)
    east = rcurve.transverse(middle[1], body) * math.cos(math.radians(middle[1]))
    metres = np.radians([east, rcurve.meridian(middle[1], body)])
    placed = _placed(affine * metres[:, None], keys, page)
    note = f"its pixels are {what}: projected about its middle, {middle[1]:.6g}, {middle[0]:.6g}"
    return replace(placed, notes=(note, *placed.notes[:-1]))


def _unrolled(
    affine: Affine, keys: Mapping[str, Any], page: tifffile.TiffPage
) -> tuple[Affine, str] | None:
    """A cylindrical map's metres as degrees about the middle, and its name; None if they are true.

    Equirectangular ones, as of the Moon and Mars, are longer than the ground along any parallel but one,
    Mercator's (J. P. Snyder, USGS Professional Paper 1395) along the meridian, too.
    """
    number, body = keys.get("ProjectedCSTypeGeoKey", 0), _ellipsoid(keys)
    kind = CYLINDERS.get(number, keys.get("ProjCoordTransGeoKey"))
    if kind not in CALLED or horizontal_unit(keys) != METRE:
        return None
    standard = keys.get("ProjStdParallel1GeoKey", 0.0)
    parallel = _parallel(standard, body) * keys.get("ProjScaleAtNatOriginGeoKey", 1.0)
    y = (affine @ _half(keys, page))[1] - keys.get("ProjFalseNorthingGeoKey", 0.0)
    if kind == EQUIRECTANGULAR:  # as of a sphere, says PROJ
        latitude = math.degrees(y / body.semimajor_axis) + keys.get("ProjCenterLatGeoKey", 0.0)
    else:
        sphere = Ellipsoid(body.semimajor_axis, body.semimajor_axis)
        latitude = isometric2geodetic(math.degrees(y / parallel), sphere if kind == WEB else body)
    stretch = parallel / _parallel(latitude, body)
    if not abs(latitude) < 90.0 or (kind != WEB and abs(stretch - 1.0) < LEAST_STRETCH):
        return None
    along = rcurve.meridian(latitude, body) * (stretch if kind == MERCATOR else 1.0)
    if kind == EQUIRECTANGULAR:
        along = body.semimajor_axis
    if kind == WEB:
        along = parallel / math.cos(math.radians(latitude))
    degrees = affine * np.degrees([[1.0 / parallel], [1.0 / along]])
    degrees[1, 2] += latitude - (degrees @ _half(keys, page))[1]
    return degrees, CALLED[kind]


def _polar_stretch(affine: Affine, keys: Mapping[str, Any], page: tifffile.TiffPage) -> float:
    """How much longer than the ground a polar stereographic map is in its middle (Snyder's sphere)."""
    true_at = POLAR.get(keys.get("ProjectedCSTypeGeoKey", 0))
    if keys.get("ProjCoordTransGeoKey") == STEREOGRAPHIC:
        true_at = abs(keys.get("ProjNatOriginLatGeoKey", 90.0))
    if true_at is None:
        return 1.0
    x, y = affine @ _half(keys, page)
    origin = keys.get("ProjFalseEastingGeoKey", 0.0), keys.get("ProjFalseNorthingGeoKey", 0.0)
    at_true = (1.0 + math.sin(math.radians(true_at))) * keys.get("ProjScaleAtNatOriginGeoKey", 1.0)
    away = math.hypot(x - origin[0], y - origin[1]) / (_ellipsoid(keys).semimajor_axis * at_true)
    return float(at_true / (1.0 + math.cos(2.0 * math.atan(away))))


def _is_of_the_globe(affine: Affine, keys: Mapping[str, Any], page: tifffile.TiffPage) -> bool:
    """Whether squares of ground are none in its projection; a sinusoidal one is true in its middle."""
    kind = keys.get("ProjCoordTransGeoKey")
    origin = keys.get("ProjFalseEastingGeoKey", 0.0), keys.get("ProjFalseNorthingGeoKey", 0.0)
    x, y = (affine @ _half(keys, page) - origin) / _ellipsoid(keys).semimajor_axis
    if kind == SINUSOIDAL:
        return bool(abs(x * math.tan(y)) > math.sin(MOST_SKEW))
    if kind == AZIMUTHAL:
        return bool(1.0 - (x * x + y * y) / 4.0 < (1.0 + MOST_SQUEEZE) ** -2)
    is_named = NAMED_OF_THE_GLOBE.search(str(keys.get("PCSCitationGeoKey", ""))) is not None
    return is_named or kind in OF_THE_GLOBE or keys.get("ProjectedCSTypeGeoKey") in EQUAL_AREAS


def _parallel(latitude: float, body: Ellipsoid) -> float:
    """Radius of a parallel [m]."""
    return float(rcurve.transverse(latitude, body)) * math.cos(math.radians(latitude))


def _ellipsoid(keys: Mapping[str, Any]) -> Ellipsoid:
    """The body that the keys tell, which may be the Moon; WGS-84 if they tell none."""
    major = keys.get("GeogSemiMajorAxisGeoKey")
    if major is None:
        return WGS84
    inverse = keys.get("GeogInvFlatteningGeoKey", 0.0)
    minor = keys.get("GeogSemiMinorAxisGeoKey", major * (1.0 - 1.0 / inverse) if inverse else major)
    return Ellipsoid(major, minor)


def _half(keys: Mapping[str, Any], page: tifffile.TiffPage) -> tuple[float, float, float]:
    """The middle of a page, in columns and rows."""
    outer = 1 if keys.get("GTRasterTypeGeoKey") == PIXEL_IS_POINT else 0
    rows, columns = page.shape
    return (columns - outer) / 2, (rows - outer) / 2, 1.0


def _affine(page: tifffile.TiffPage) -> Affine | None:
    """The map from columns and rows, counted from the corner of the first pixel, to coordinates."""
    scale, full = _numbers(page, PIXEL_SCALE, 2), _numbers(page, TRANSFORMATION, 16)
    if scale is not None:
        # A negative depth is a writer's mistake, says GDAL: rows run south all the same. Not so a width.
        width, depth = scale[0], abs(scale[1])
        column, row, _, x, y, _ = _numbers(page, TIE_POINTS, 6) or (0.0,) * 6
        affine = np.array([[width, 0.0, x - width * column], [0.0, -depth, y + depth * row]])
    elif full is not None:
        affine = np.array(full, np.float64).reshape(4, 4)[:2, [0, 1, 3]]
    elif (beside := _world_file(page)) is not None:
        affine = beside
    else:
        return None
    usable = np.isfinite(affine).all() and np.abs(affine[:, :2]).max(axis=0).all()
    return affine if usable else None


def _world_file(page: tifffile.TiffPage) -> Affine | None:
    """What a file beside a page's says of its pixels, of which it places the middle of the first."""
    path = Path(page.parent.filehandle.path)
    files = (path.with_suffix(suffix) for suffix in WORLD_FILES)
    file = next((file for file in files if file.is_file()), None)
    if file is None:
        return None
    words = read_bytes(file, LARGEST_WORLD_FILE).decode("ascii", "replace").split()
    try:
        a, d, b, e, x, y = map(number, words)
    except ValueError:
        raise UsageError(
            f"{file.name} beside it is no world file, which has six numbers; mend it or take it away"
        ) from None
    return np.array([[a, b, x - (a + b) / 2], [d, e, y - (d + e) / 2]])


def _numbers(page: tifffile.TiffPage, tag: int, count: int) -> tuple[float, ...] | None:
    """The first of a tag's numbers; None if it has fewer."""
    numbers = page.tags.valueof(tag)
    return numbers[:count] if isinstance(numbers, tuple) and len(numbers) >= count else None


def _placed(affine: Affine, keys: Mapping[str, Any], page: tifffile.TiffPage) -> Grid:
    (east_column, east_row), (north_column, north_row) = affine[:, :2].tolist()
    columns, rows = (math.hypot(*step) for step in affine[:, :2].T.tolist())
    if abs(east_column * east_row + north_column * north_row) > math.sin(MOST_SKEW) * columns * rows:
        raise UsageError("its rows and columns are not at right angles (gdalwarp straightens them)")
    if transposed := abs(east_column) < abs(east_row):
        columns, rows = rows, columns
        east_column, north_column, north_row = east_row, north_row, north_column
    mirrored, upside_down = east_column < 0.0, north_row > 0.0
    turn = math.degrees(math.atan2(-north_column if mirrored else north_column, abs(east_column)))
    name, metres = UNITS[horizontal_unit(keys)]
    notes = []
    if not keys:
        notes.append("names no coordinate system: its pixels are taken to be metres")
    if metres != 1.0:
        notes.append(f"its unit is the {name}, {metres:.6g} m")
    if transposed or mirrored or upside_down:
        notes.append("rows do not run from west to east, from north to south: turned so that they do")
    if abs(turn) > SMALLEST_TURN:
        notes.append(f"+x is {turn:.1f} deg north of its coordinates' east")
    if abs((stretch := _polar_stretch(affine, keys, page)) - 1.0) > LEAST_STRETCH:
        notes.append(f"its polar map is {stretch:.4g} times as long as the ground here: made as long")
        columns, rows = columns / stretch, rows / stretch
    x, y = (affine @ _half(keys, page)).tolist()
    notes.append(f"its middle, the origin, is {x:.10g}, {y:.10g} in its coordinates")
    return Grid(
        pixel=SQUEEZED if _is_of_the_globe(affine, keys, page) else (columns * metres, rows * metres),
        height_unit=height_unit(keys, metres),
        transposed=transposed,
        mirrored=mirrored,
        upside_down=upside_down,
        notes=tuple(notes),
    )
