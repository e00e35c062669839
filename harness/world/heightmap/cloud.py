"""A cloud of points becomes heights on a grid: PLY, LAS and LAZ (extra [cloud]), N x 3 arrays."""

import math
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError
from harness.world.heightfield import Field

SUFFIXES = (".ply", ".las", ".laz")
MOST_POINTS = 50_000_000
FEWEST_POINTS = 64
FINEST, COARSEST = 0.05, 10.0  # [m] of a cell that is chosen
A_CELL = 4.0  # points that a cell is to have
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


def read_points(path: Path) -> Points:
    """Returns the points of a file [m]; UsageError if there are too many or none.

    Raises:
        ImportError: laspy is missing, which reads LAS and LAZ.
    """
    kind = path.suffix.lower()
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
        points = _read_las(path)
    points = points[np.isfinite(points).all(axis=1)]
    _check_count(len(points))
    return points


def _read_las(path: Path) -> Points:
    import laspy  # noqa: PLC0415 - its extra may be missing

    with laspy.open(path) as file:
        _check_count(file.header.point_count)
        cloud = file.read()
    return np.column_stack([cloud.x, cloud.y, cloud.z]).astype(np.float64)


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
    where = f"its middle, the origin, is {middle} in its coordinates"
    return heights.reshape(rows, columns)[::-1], cell, (note, where)
