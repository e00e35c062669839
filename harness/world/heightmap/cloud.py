"""A cloud of points becomes heights on a grid: PLY, LAS and LAZ (extra [cloud]), N x 3 arrays."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.world.heightfield import Field
from harness.world.heightmap.units import MERCATORS, UNITS, height_unit, horizontal_unit, wkt_units

SUFFIXES = (".ply", ".las", ".laz")
MOST_POINTS = 50_000_000
FEWEST_POINTS = 64
FINEST, COARSEST = 0.05, 10.0  # [m] of a cell that is chosen
MOST_DEGREES = 1.0  # along a side, of a cloud in longitudes and latitudes
A_CELL = 4.0  # points that a cell is to have
# Classes of ASPRS (LAS 1.4 R15): vegetation, buildings, wires and their like, and noise.
NO_GROUND = (3, 4, 5, 6, 7, 13, 14, 15, 16, 18)
WKT, GEO_KEYS, GEO_TEXTS = 2112, 34735, 34737  # records of LAS
Points = NDArray[np.float64]  # x, y, z [m], shape (n, 3)


def is_cloud(path: Path) -> bool:
    """Returns whether a file holds points by its suffix or, of an array, by its three columns."""
    if path.suffix.lower() in SUFFIXES:
        return True
    if path.suffix.lower() != ".npy" or not path.is_file():
        return False
    try:
        shape = np.load(path, mmap_mode="r", allow_pickle=False).shape
    except (OSError, ValueError, EOFError):
        return False  # reading it says what is wrong
    return len(shape) == 2 and shape[1] == 3


def read_points(path: Path) -> tuple[Points, tuple[str, ...]]:
    """Returns a file's points [m], and notes of their unit; UsageError if they are too many or none.

    Raises:
        ImportError: laspy is missing, which reads LAS and LAZ.
    """
    kind, notes = path.suffix.lower(), tuple[str, ...]()
    if kind == ".npy":
        array = np.load(path, mmap_mode="r", allow_pickle=False)
        _check_count(len(array))
        points = np.array(array, np.float64)
    elif kind == ".ply":
        import trimesh  # noqa: PLC0415 - most terrains do without

        with path.open("rb") as file:
            loaded = trimesh.load(file, file_type="ply", process=False)
        points = np.array(getattr(loaded, "vertices", np.empty((0, 3))), np.float64)
    else:
        points, notes = _read_las(path)
    points = points[np.isfinite(points).all(axis=1)]
    _check_count(len(points))
    return points, notes


def _read_las(path: Path) -> tuple[Points, tuple[str, ...]]:
    import laspy  # noqa: PLC0415 - its extra may be missing

    with laspy.open(path) as file:
        _check_count(file.header.point_count)
        cloud = file.read()
    ground, height = _las_units({v.record_id: v.record_data_bytes() for v in cloud.header.vlrs})
    points = np.column_stack([cloud.x, cloud.y, cloud.z]).astype(np.float64) * [ground, ground, height]
    notes = list[str]()
    if not ground == height == 1.0:
        notes.append(f"its units, as it says: {ground:.6g} m of the ground, {height:.6g} m of heights")
    if (others := np.isin(cloud.classification, NO_GROUND) | np.asarray(cloud.withheld, np.bool_)).any():
        notes.append(f"{others.sum():,} points left out: vegetation, buildings, noise, as it says")
    return points[~others], tuple(notes)


def _las_units(records: Mapping[int, bytes]) -> tuple[float, float]:
    """Lengths of the units of ground and heights [m] by the records of a LAS file: WKT, or GeoKeys."""
    # Imported here: no run without a cloud waits for it.
    from tifffile.geodb import GeoKeys as TiffKeys  # noqa: PLC0415

    from harness.world.heightmap.geotiff import CYLINDERS, MERCATOR, WEB, spelled_out  # noqa: PLC0415

    wkt = records.get(WKT, b"").decode("utf-8", "replace")
    directory = np.frombuffer(records.get(GEO_KEYS, b"")[8:], "<u2").reshape(-1, 4).tolist()
    texts = records.get(GEO_TEXTS, b"").decode("ascii", "replace")
    keys: dict[str, Any] = {
        TiffKeys(key).name: value if place == 0 else texts[value : value + count]
        for key, place, count, value in directory
        if key in {*TiffKeys} and place in (0, GEO_TEXTS)
    }
    keys = spelled_out(keys)
    projection = CYLINDERS.get(keys.get("ProjectedCSTypeGeoKey", 0), keys.get("ProjCoordTransGeoKey"))
    if MERCATORS.search(wkt) or projection in (WEB, MERCATOR):
        raise UsageError("it is in Mercator, which stretches the ground; give it in UTM (pdal, las2las)")
    if wkt:
        return wkt_units(wkt)
    unit = horizontal_unit(keys)
    if unit not in UNITS:
        raise UsageError(f"its unit {unit} is not known; give it in metres (pdal, las2las)")
    ground = UNITS[unit][1]
    return ground, height_unit(keys, ground) or ground


def _check_count(count: int) -> None:
    if not FEWEST_POINTS <= count <= MOST_POINTS:
        raise UsageError(f"it has {count:,} points; {FEWEST_POINTS} to {MOST_POINTS:,} become ground")


def gridded(points: Points, cell: float | None) -> tuple[Field, float, tuple[str, ...]]:
    """Returns the heights of a cloud [m], the distance of two of them, and notes of what was done.

    A height is the mean of the points of a cell around it, NaN where there are none. The first row is
    in the north, the first column in the west. Without a cell [m], one has A_CELL points.
    """
    low, high = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    width, depth = (high - low).tolist()
    if max(width, depth) < MOST_DEGREES:
        message = (
            f"its points lie within {width:.3g} x {depth:.3g} m; if they are in degrees, give metres"
        )
        raise UsageError(f"{message}, as in UTM (pdal, las2las)")
    if cell is None:
        spacing = math.sqrt(max(width * depth, FINEST**2) * A_CELL / len(points))
        cell = float(f"{min(max(spacing, FINEST), COARSEST):.2g}")
    columns, rows = (round(length / cell) + 1 for length in (width, depth))
    if columns * rows > MOST_POINTS:
        message = f"{columns} x {rows} cells of {cell:g} m are too many; give a larger --terrain-cell"
        raise UsageError(message)
    column, row = np.rint((points[:, :2] - low) / cell).astype(np.int64).T
    index = row * columns + column
    count = np.bincount(index, minlength=rows * columns)
    with np.errstate(invalid="ignore"):
        heights = np.bincount(index, points[:, 2], minlength=rows * columns) / count
    middle = ", ".join(f"{value:.10g}" for value in (low + high) / 2)
    note = f"{len(points):,} points become a height each {cell:g} m, the mean of those around it"
    where = f"its middle, the origin, is {middle} in its coordinates in metres"
    return heights.reshape(rows, columns)[::-1], cell, (note, where)
