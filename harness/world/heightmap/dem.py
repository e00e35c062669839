"""A world from a heightmap file: square, without gaps, with a start on which a rover can stand.

The data are not altered where they need not be: pixels between 5 cm and the map's limit become vertices
as they are. Whatever is done (filled, cropped, resampled, scaled) is told in a note.
"""

import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from harness.errors import UsageError
from harness.world.heightfield import Field, Heightfield, filled, resampled
from harness.world.heightmap.raster import Raster, read_raster
from harness.world.statistics import slopes
from harness.world.terrain import HEIGHT_DECIMALS
from harness.world.terrains import TERRAINS
from harness.world.world import DEFAULT_DIFFICULTY, World

SUFFIXES = (".tif", ".tiff", ".png", ".npy")
FINEST_CELL = 0.05  # [m]: a step costs more the smaller the cells under a wheel are
MOST_VERTICES = 1500  # along a side
SMALLEST_MAP, LARGEST_MAP = 10.0, 50_000.0  # [m] along a side
LARGEST_RELIEF = 10_000.0  # [m]
MOST_MISSING = 0.5  # share of heights that may be filled in
STEEPEST_START = 15.0  # [deg]
START_REACH = 0.4  # [m] around the start that must not be steeper
START_SEARCH = 0.25  # of the map's side, from its middle


@dataclass(frozen=True, kw_only=True)
class TerrainFile:
    """A heightmap and what its file may leave open.

    Attributes:
        path: The file.
        size: Length of the map along x and y [m]; None as the file says.
        relief: From the lowest to the highest point [m]; None as the file says.
    """

    path: Path
    size: tuple[float, float] | None = None
    relief: float | None = None

    def check(self) -> None:
        """Checks the two numbers.

        Raises:
            UsageError: One is not valid.
        """
        for length in self.size or ():
            if not SMALLEST_MAP <= length <= LARGEST_MAP:
                raise UsageError(
                    f"terrain size {length:g} m is not valid; give {SMALLEST_MAP:g} to {LARGEST_MAP:g}"
                )
        if self.relief is not None and not 0.0 <= self.relief <= LARGEST_RELIEF:
            raise UsageError(
                f"terrain height {self.relief:g} m is not valid; give 0 to {LARGEST_RELIEF:g}"
            )


def is_terrain_file(name: str) -> bool:
    """Returns whether the name of a terrain means a file rather than one of the named terrains."""
    if name in TERRAINS:
        return False
    return os.sep in name or name.lower().endswith(SUFFIXES) or Path(name).exists()


def file_world(file: TerrainFile, seed: int) -> World:
    """Makes a world without obstacles from a heightmap.

    Raises:
        UsageError: The file is not readable, incomplete, or nowhere fit to stand on.
    """
    raster = read_raster(file.path)
    try:
        ground, notes = _ground(raster, file)
    except UsageError as error:
        raise UsageError(f"terrain {file.path}: {error}") from error
    return World(file.path.name, ground, (), seed, DEFAULT_DIFFICULTY, notes=notes)


def _ground(raster: Raster, file: TerrainFile) -> tuple[Heightfield, tuple[str, ...]]:
    notes: list[str] = []
    pixel = _pixel(raster, file)
    values = _cropped(raster.values, pixel, notes)
    values = _complete(values, notes)
    heights = _in_metres(values, raster, file.relief, notes)
    heights, cell = _on_cells(heights, pixel, notes)
    row, column = _start(heights, cell)
    heights = _centred(heights, row, column, cell, notes)
    heights = np.round(heights - heights.min(), HEIGHT_DECIMALS) + 0.0
    return Heightfield(np.ascontiguousarray(heights[::-1]), cell), tuple(notes)


def _pixel(raster: Raster, file: TerrainFile) -> tuple[float, float]:
    rows, columns = raster.values.shape
    if file.size is not None:
        return file.size[0] / (columns - 1), file.size[1] / (rows - 1)
    if isinstance(raster.pixel, str):
        raise UsageError(f"{raster.pixel}; give --terrain-size in metres")
    width, depth = _extent(raster.values, raster.pixel)
    if not SMALLEST_MAP <= min(width, depth) <= max(width, depth) <= LARGEST_MAP:
        raise UsageError(
            f"it is {width:g} x {depth:g} m; between {SMALLEST_MAP:g} and {LARGEST_MAP:g} m can be "
            "driven; --terrain-size overrides what it says"
        )
    return raster.pixel


def _extent(values: Field, pixel: tuple[float, float]) -> tuple[float, float]:
    """Width and depth [m]."""
    rows, columns = values.shape
    return pixel[0] * (columns - 1), pixel[1] * (rows - 1)


def _cropped(values: Field, pixel: tuple[float, float], notes: list[str]) -> Field:
    """The largest square in metres around the middle."""
    width, depth = _extent(values, pixel)
    side = min(width, depth)
    kept = [math.floor(side / step + 1e-6) + 1 for step in reversed(pixel)]
    spare = [max(0, count - keep) for count, keep in zip(values.shape, kept, strict=True)]
    if not any(spare):
        return values
    notes.append(f"{width:.4g} x {depth:.4g} m cropped to the middle {side:.4g} m")
    row, column = (count // 2 for count in spare)
    return values[row : row + kept[0], column : column + kept[1]]


def _complete(values: Field, notes: list[str]) -> Field:
    missing = int(np.isnan(values).sum())
    if not missing:
        return values
    share = missing / values.size
    if share > MOST_MISSING:
        raise UsageError(
            f"{share:.0%} of its heights are missing; at most {MOST_MISSING:.0%} are filled"
        )
    notes.append(f"{missing} missing heights ({share:.2%}) filled from their surroundings")
    return filled(values)


def _in_metres(values: Field, raster: Raster, relief: float | None, notes: list[str]) -> Field:
    lowest, extent = float(values.min()), float(np.ptp(values))
    if relief is None:
        if not raster.in_metres:
            raise UsageError("its values are no metres; give --terrain-height, lowest to highest point")
        if extent > LARGEST_RELIEF:
            raise UsageError(f"its relief is {extent:g} m; give --terrain-height if that is no metres")
        return values
    notes.append(f"values {lowest:g} to {lowest + extent:g} scaled to {relief:g} m of relief")
    return (values - lowest) * (relief / extent if extent else 0.0)


def _on_cells(heights: Field, pixel: tuple[float, float], notes: list[str]) -> tuple[Field, float]:
    """Heights on square cells of a size that can be simulated, and that size [m]."""
    side = min(_extent(heights, pixel))
    cell = max(min(pixel), FINEST_CELL, side / (MOST_VERTICES - 1))
    count = math.floor(side / cell + 1e-6) + 1
    if heights.shape == (count, count) and math.isclose(pixel[0], pixel[1], rel_tol=1e-9):
        return heights, pixel[0]
    notes.append(f"pixels of {pixel[0]:.4g} x {pixel[1]:.4g} m resampled to cells of {cell:.4g} m")
    return resampled(heights, (cell / pixel[1], cell / pixel[0]), count), cell


def _start(heights: Field, cell: float) -> tuple[int, int]:
    """The vertex next to the middle around which the ground is gentle.

    Raises:
        UsageError: There is none within reach; the message tells how steep it is.
    """
    from scipy.ndimage import maximum_filter  # noqa: PLC0415 - 0.1 s that named terrains save

    middle, reach = (len(heights) - 1) / 2, math.ceil(START_REACH / cell)
    steepest = maximum_filter(slopes(Heightfield(heights, cell)), 2 * reach + 1, mode="nearest")
    axis = np.arange(len(heights)) - middle
    distance = np.hypot(axis[:, None], axis[None, :])
    searched = distance <= START_SEARCH * len(heights)
    fit = searched & (steepest <= STEEPEST_START)
    if not fit.any():
        radius, gentlest = START_SEARCH * len(heights) * cell, steepest[searched].min()
        raise UsageError(
            f"no rover can stand within {radius:.3g} m of its middle: the gentlest place is "
            f"{gentlest:.0f} deg steep, not {STEEPEST_START:g}; check --terrain-size and -height"
        )
    row, column = np.unravel_index(np.argmin(np.where(fit, distance, np.inf)), heights.shape)
    return int(row), int(column)


def _centred(heights: Field, row: int, column: int, cell: float, notes: list[str]) -> Field:
    """The largest square with the start in its middle, where a rover is set down."""
    last = len(heights) - 1
    middle = last / 2
    if max(abs(row - middle), abs(column - middle)) <= 0.5:
        return heights
    reach = min(row, column, last - row, last - column)
    moved = math.hypot(row - middle, column - middle) * cell
    notes.append(
        f"starts {moved:.3g} m off its middle, on gentle ground; {2 * reach * cell:.4g} m remain"
    )
    return heights[row - reach : row + reach + 1, column - reach : column + reach + 1]
