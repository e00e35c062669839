"""A world from a heightmap file: the whole of it, without gaps, with a start on which a rover can stand.

The data are not altered where they need not be: square pixels between 5 cm and the map's limit become
vertices as they are. Whatever is done (filled, resampled, scaled) and what came of it stands in a note.
"""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.ndimage import maximum_filter

from harness.base.errors import UsageError
from harness.base.streams import DETAIL, generator
from harness.spec.world import LARGEST_MAP, LARGEST_RELIEF, ROUGHNESS, SMALLEST_MAP, WorldSpec
from harness.world.heightfield import Field, Heightfield, filled, finer, finest_cell, resampled
from harness.world.heightmap.raster import Raster, read_raster
from harness.world.statistics import slopes
from harness.world.terrain import HEIGHT_DECIMALS
from harness.world.world import ORIGIN, STEEPEST_START, RoverNeeds, Start, World

FINEST_CELL = 0.05  # [m]: a step costs more the smaller the cells under a wheel are
MOST_MISSING = 0.5  # share of heights that may be filled in
DOUBTED = (0, -1, -99, -999, -9999, -32767, -32768, 9999, 32767, 65535)  # if they stand apart
SMALLEST_LOSS = 0.01  # of a cell, at the edges, that is noted
START_REACH = 0.4  # [m] around the start that must not be steeper
START_SEARCH = 0.25  # of the map's shorter side, from its middle


def heightmap_world(spec: WorldSpec, seed: int, rover: RoverNeeds) -> World:
    """Makes a world without obstacles from a heightmap, with a start where the rover needs one.

    Args:
        spec: Names the file, its cell, size and relief.
        seed: Of what is added to it.
        rover: What a rover needs of a world.

    Raises:
        UsageError: The file is not readable or no terrain.
    """
    path = Path(spec.terrain)
    raster = read_raster(path, spec.terrain_cell)
    try:
        notes = list(raster.notes)
        ground = _ground(raster, spec, seed, notes)
        if ground.cell > rover.wheel_radius > 0.0:
            notes.append(
                f"its cells of {ground.cell:.3g} m are coarser than the wheels, whose radius is "
                f"{rover.wheel_radius:.3g} m: what is smaller is not there"
            )
        start = _start(ground, notes) if rover.needs_start else ORIGIN
    except UsageError as error:
        raise UsageError(f"terrain {path}: {error}") from error
    return World(path.name, ground, (), seed, None, tuple(notes), start)


def _ground(raster: Raster, spec: WorldSpec, seed: int, notes: list[str]) -> Heightfield:
    pixel = _pixel(raster, spec.terrain_size)
    values = _complete(raster.values, notes)
    _doubt(values, notes)
    heights = _in_metres(values, raster, spec.terrain_height, notes)
    heights, cell = _on_cells(heights, pixel, notes)
    ground = Heightfield(np.ascontiguousarray(heights[::-1]), cell)
    if spec.terrain_roughness:
        finest = _finest(*(2 * half for half in ground.half_size))
        ground, note = detailed(ground, spec.terrain_roughness, seed, finest)
        notes.append(note)
    heights = np.round(ground.heights - ground.heights.min(), HEIGHT_DECIMALS) + 0.0
    ground = replace(ground, heights=heights)
    notes.append(f"{ground.describe()}, relief {np.ptp(heights):.4g} m")
    return ground


def _pixel(raster: Raster, size: tuple[float, float] | None) -> tuple[float, float]:
    rows, columns = raster.values.shape
    if size is not None:
        return size[0] / (columns - 1), size[1] / (rows - 1)
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


def _complete(values: Field, notes: list[str]) -> Field:
    missing = int(np.isnan(values).sum())
    if not missing:
        return values
    share = missing / values.size
    if share > MOST_MISSING:
        raise UsageError(
            f"{share:.0%} of its heights are missing; at most {MOST_MISSING:.0%} are filled: give a "
            "part, or of a cloud metres and a larger --terrain-cell"
        )
    notes.append(f"{missing} missing heights ({share:.2%}) filled from their surroundings")
    return filled(values)


def _doubt(values: Field, notes: list[str]) -> None:
    """Notes a few of DOUBTED that are further from all other values than these from each other.

    They often mean no data; of a plane with a step on it zeros are the greater part.
    """
    for doubted in DOUBTED:
        rest = values[values != doubted]
        count = values.size - rest.size
        if 0 < count < rest.size and np.abs(rest - doubted).min() > np.ptp(rest):
            notes.append(
                f"{count} of its values ({count / values.size:.2%}) are {doubted:g}, all others "
                f"{rest.min():g} to {rest.max():g}: if {doubted:g} means that there are none, "
                f"gdal_translate -a_nodata {doubted:g} tells so"
            )


def _in_metres(values: Field, raster: Raster, relief: float | None, notes: list[str]) -> Field:
    lowest, extent = float(values.min()), float(np.ptp(values))
    if relief is None:
        if not raster.in_metres:
            raise UsageError(
                "it does not say that its values are metres; give --terrain-height, lowest to highest "
                "point"
            )
        if extent > LARGEST_RELIEF:
            raise UsageError(f"its relief is {extent:g} m; give --terrain-height if that is no metres")
        return values
    notes.append(f"values {lowest:g} to {lowest + extent:g} scaled to {relief:g} m of relief")
    return (values - lowest) * (relief / extent if extent else 0.0)


def _on_cells(heights: Field, pixel: tuple[float, float], notes: list[str]) -> tuple[Field, float]:
    """Heights on square cells of a size that can be simulated, and that size [m]."""
    width, depth = _extent(heights, pixel)
    cell = max(min(pixel), _finest(width, depth))
    if math.isclose(pixel[0], pixel[1], rel_tol=1e-9) and cell <= pixel[0] * (1 + 1e-9):
        return heights, pixel[0]
    rows, columns = (math.floor(length / cell + 1e-6) + 1 for length in (depth, width))
    lost_x, lost_y = (max(0.0, w - (n - 1) * cell) for w, n in ((width, columns), (depth, rows)))
    note = f"pixels of {pixel[0]:.4g} x {pixel[1]:.4g} m resampled to cells of {cell:.4g} m"
    cut = f", {lost_x:.2g} m along x and {lost_y:.2g} m along y cut off at the edges"
    notes.append(note + (cut if max(lost_x, lost_y) > SMALLEST_LOSS * cell else ""))
    return resampled(heights, (cell / pixel[1], cell / pixel[0]), (rows, columns)), cell


def _finest(width: float, depth: float) -> float:
    """The smallest cells [m] that a map of a size [m] can be simulated in."""
    return max(FINEST_CELL, finest_cell(width, depth))


def _start(ground: Heightfield, notes: list[str]) -> Start:
    """The vertex next to the middle around which the ground is gentle; UsageError if none is near."""
    (half_x, half_y), cell = ground.half_size, ground.cell
    rows, columns = ground.heights.shape
    steepest = maximum_filter(slopes(ground), 2 * math.ceil(START_REACH / cell) + 1, mode="nearest")
    x, y = cell * np.arange(columns) - half_x, cell * np.arange(rows) - half_y
    distance = np.hypot(y[:, None], x[None, :])
    radius = START_SEARCH * cell * min(rows, columns)
    searched = distance <= radius
    fit = searched & (steepest <= STEEPEST_START)
    if not fit.any():
        gentlest = steepest[searched].min()
        raise UsageError(
            f"no rover can stand within {radius:.3g} m of its middle: the gentlest place is "
            f"{gentlest:.0f} deg steep, not {STEEPEST_START:g}; check --terrain-size and -height, or "
            "choose a --start"
        )
    row, column = np.unravel_index(np.argmin(np.where(fit, distance, np.inf)), fit.shape)
    if distance[row, column] < cell:  # as near as a vertex can be
        return ORIGIN
    start = round(float(x[column]), 3), round(float(y[row]), 3), 0.0
    notes.append(f"starts at {start[0]:g},{start[1]:g}: in its middle, 0,0, the ground is too steep")
    return start


# ISO 8608:2016 describes the profile along a line over the ground by its one-sided power spectral
# density G(n) = G(n0) (n / n0)^-2 of spatial frequency n; each class has four times the density of the
# one before. An isotropic surface whose profiles have it has the density S(f) = G(n0) n0^2 / (4 f^3)
# over the plane of frequencies, since the integral of (1 + t^2)^(-3/2) is 2.
N_0 = 0.1  # [cycles/m]
HIGHEST = 2.83  # [cycles/m] up to which the standard speaks; what is shorter, tyres swallow
CLASS_A = 16e-6  # [m^3] density at N_0, the geometric mean of the class


def detailed(ground: Heightfield, name: str, seed: int, cell: float) -> tuple[Heightfield, str]:
    """Returns a ground with detail in finer cells, and what was done.

    Args:
        ground: In coarse cells, which have nothing shorter than two of them.
        name: Of a class, one of ROUGHNESS.
        seed: Of the world.
        cell: As fine as cells may be [m].
    """
    parts = math.floor(ground.cell / cell + 1e-9)
    if parts < 2:
        return ground, f"cells of {ground.cell:.3g} m cannot be finer here: there is no detail"
    fine = finer(ground, parts)
    longest, density = 2.0 * ground.cell, CLASS_A * 4.0 ** ROUGHNESS.index(name)
    detail = _surface(generator(seed, DETAIL), fine, longest, density)
    note = (
        f"detail of ISO 8608's class {name} below {longest:.3g} m, its RMS {detail.std():.2g} m, "
        f"in cells of {fine.cell:.3g} m"
    )
    return Heightfield(fine.heights + detail, fine.cell, fine.middle), note


def _surface(rng: np.random.Generator, ground: Heightfield, longest: float, density: float) -> Field:
    """Random heights [m] of a density at N_0 [m^3], of wavelengths from HIGHEST to the longest [m]."""
    shape, cell = ground.heights.shape, ground.cell
    frequency = np.hypot(np.fft.fftfreq(shape[0], cell)[:, None], np.fft.rfftfreq(shape[1], cell))
    with np.errstate(divide="ignore"):
        amplitude = np.sqrt(density * N_0**2 / 4.0 / frequency**3) / cell
    amplitude[(frequency * longest < 1.0) | (frequency > HIGHEST)] = 0.0
    return np.asarray(np.fft.irfft2(np.fft.rfft2(rng.standard_normal(shape)) * amplitude, s=shape))
