"""Worlds of BARN as others have them: Gazebo's files with or without paths, or tables."""

import math
import re
from collections import defaultdict
from itertools import pairwise
from pathlib import Path

import numpy as np
import pandas as pd

from harness.base.documents import read_bytes
from harness.base.errors import UsageError
from harness.course.task import WorldFile
from harness.course.tracks.sdf import Circle, world_text

LARGEST = 64 * 2**20  # bytes
MOST = 1000  # worlds
START, GOAL = (-2.25, 3.0), (-2.25, 13.0)
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


def path_length(points: list[tuple[float, float]]) -> float:
    """Returns the length of a way from BARN's start through points to its goal [m]."""
    way = [START, *points, GOAL]
    return math.fsum(math.dist(a, b) for a, b in pairwise(way))


def _of_files(folder: Path) -> list[WorldFile]:
    found = sorted(path for path in folder.rglob("*") if path.suffix.lower() in (".world", ".sdf"))
    return [
        WorldFile(path.name, read_bytes(path, LARGEST), _path_of(path))
        for path in sorted(found, key=lambda path: (_number(path.stem), path.name))
    ]


def _number(name: str) -> int:
    digits = re.findall(r"\d+", name)
    return int(digits[-1]) if digits else 0


def _path_of(world: Path) -> float | None:
    """The length of the path beside a world, if there is one."""
    name = f"path_{_number(world.stem)}.npy"
    tops = world.parent, world.parent.parent
    places = (world.parent / name, *(top / "path_files" / name for top in tops))
    file = next((place for place in places if place.is_file()), None)
    if file is None:
        return None
    try:
        cells = np.load(file, allow_pickle=False).astype(np.float64).reshape(-1, 2)
    except (OSError, ValueError, TypeError) as error:
        raise UsageError(f"{file} is no path of cells, shape (n, 2): {error}") from error
    x, y = PATH_CORNER
    return path_length([(x + PATH_CELL * i, y + PATH_CELL * j) for i, j in cells.tolist()])


def _of_table(file: Path) -> list[WorldFile]:
    by_world: dict[int, list[Circle]] = defaultdict(list)
    rows = _rows(file, ("world", "x", "y"))
    radii = rows["radius"] if "radius" in rows else [0.075] * len(rows)
    for world, x, y, radius in zip(rows["world"], rows["x"], rows["y"], radii, strict=True):
        by_world[int(world)].append((float(x), float(y), float(radius)))
    paths = _paths(file.parent / PATHS)
    return [
        WorldFile(f"barn_{number}.sdf", world_text(f"barn_{number}", sorted(circles)), paths.get(number))
        for number, circles in sorted(by_world.items())
    ]


def _paths(file: Path) -> dict[int, float]:
    if not file.is_file():
        return {}
    rows = _rows(file, ("world", "x", "y"))
    lengths = {}
    for number, own in rows.groupby("world"):
        points = [*zip(own["x"].tolist(), own["y"].tolist(), strict=True)]
        inner = [point for point in points if point not in (START, GOAL)]
        lengths[int(str(number).partition(".")[0])] = path_length(inner)
    return lengths


def _rows(file: Path, columns: tuple[str, ...]) -> pd.DataFrame:
    try:
        rows = pd.read_csv(file)
        numbers = rows[[*columns, *(c for c in ("radius",) if c in rows)]].astype(float)
    except (OSError, ValueError, KeyError, pd.errors.ParserError) as error:
        raise UsageError(f"{file} is no table with the columns {', '.join(columns)}: {error}") from error
    if not np.isfinite(numbers.to_numpy()).all():
        raise UsageError(f"{file} holds a cell that is no finite number; mend it")
    return numbers
