"""Worlds of BARN as others have them: Gazebo's files with or without paths, or tables."""

import math
import re
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from harness.base.delimited import read_csv
from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.course.task import Point, WorldFile
from harness.course.tracks.sdf import world_text

LARGEST = 64 * 2**20  # bytes
MOST = 1000  # worlds
START, GOAL = (-2.25, 3.0), (-2.25, 13.0)
RADIUS = 0.075  # [m] of a cylinder whose radius the file leaves out
TABLE, PATHS = "cylinders.csv", "paths.csv"
# The cell of a path in the world [m]: BARN's own formula.
PATH_CORNER, PATH_CELL = (-4.575, 5.075), 0.15
CONTENT = f"*.world or *.sdf, or {TABLE} with the columns world, x, y"


def read_worlds(folder: Path) -> list[WorldFile]:
    """Returns the worlds of a folder in the order of their numbers.

    Args:
        folder: With Gazebo's files, whose paths may be path_files/path_N.npy or path_N.npy, or with
            cylinders.csv (world, x, y and maybe radius [m]) and maybe paths.csv (world, i, x, y).

    Raises:
        UsageError: There are none, or one cannot be read.
    """
    if not folder.is_dir():
        raise UsageError(f"--worlds {folder} is no folder; give one with {CONTENT}")
    table = folder / TABLE
    worlds = _of_table(table) if table.is_file() else _of_files(folder)
    if not 0 < len(worlds) <= MOST:
        raise UsageError(f"--worlds {folder} holds {len(worlds)} worlds; give 1 to {MOST}: {CONTENT}")
    return worlds


def path_length(points: Iterable[Point]) -> float:
    """Returns the length of a way from BARN's start through points to its goal [m]."""
    way = [START, *(point for point in points if point not in (START, GOAL)), GOAL]
    return math.fsum(math.dist(a, b) for a, b in pairwise(way))


def _of_files(folder: Path) -> list[WorldFile]:
    paths = (path for path in folder.rglob("*") if path.suffix.lower() in (".world", ".sdf"))
    return [
        WorldFile(path.name, read_bytes(path, LARGEST), _path_of(path))
        for path in sorted(paths, key=lambda path: (_number(path), path.name, path))
    ]


def _number(path: Path) -> int:
    return int(([0, *re.findall(r"\d+", path.stem)])[-1])


def _path_of(world: Path) -> float | None:
    """The length of the path beside a world, if there is one."""
    name, folder = f"path_{_number(world)}.npy", world.parent
    places = (folder / name, folder / "path_files" / name, folder.parent / "path_files" / name)
    file = next((place for place in places if place.is_file()), None)
    if file is None:
        return None
    try:
        cells = np.load(file, allow_pickle=False).astype(np.float64).reshape(-1, 2)
    except (OSError, ValueError, TypeError) as error:
        raise UsageError(f"{file} is no path of cells, shape (n, 2): {error}") from error
    x, y = PATH_CORNER
    return path_length((x + PATH_CELL * i, y + PATH_CELL * j) for i, j in cells.tolist())


def _of_table(file: Path) -> list[WorldFile]:
    paths = file.parent / PATHS
    lengths = {} if not paths.is_file() else {n: path_length(p) for n, p in _rows(paths, "x", "y")}
    return [
        WorldFile(f"barn_{n}.sdf", world_text(f"barn_{n}", sorted(circles)), lengths.get(n))
        for n, circles in _rows(file, "x", "y", "radius")
    ]


def _rows(file: Path, *columns: str) -> list[tuple[int, list[Any]]]:
    """The rows of each world of a table, by its number; what has no radius has BARN's."""
    try:
        rows = read_csv(file, LARGEST).rename(columns=str.lower)
        rows = rows.sort_values("i", kind="stable") if "i" in rows else rows
        radius = pd.Series(rows.get("radius"), rows.index, float).fillna(RADIUS)
        values = rows.assign(radius=radius)[["world", *columns]].astype(float)
    except (ValueError, KeyError) as error:
        raise UsageError(f"{file} is no table with the columns world, x, y: {error}") from error
    if not np.isfinite(values.to_numpy()).all():
        raise UsageError(f"{file} holds a cell that is no finite number; mend it")
    groups = values.groupby("world")
    return [
        (int(str(n).partition(".")[0]), [*own[[*columns]].itertuples(index=False, name=None)])
        for n, own in groups
    ]
