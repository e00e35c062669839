"""Heights in metres over a rectangular grid: the surface of a terrain, and what terrains are built from.

The grid is centred on the world's origin, or on its `middle`. Row index runs with +y and column
index with +x, the vertices stand at the ends, and each square cell is two triangles split along
(row, col)-(row+1, col+1): exactly MuJoCo's heightfield.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from harness.base.errors import UsageError

Field = NDArray[np.float64]  # a value, mostly a height, for every vertex

MOST_VERTICES = 1500 * 1500  # of a map that is made of a file
EDGE_MARGIN = 0.5  # [m] of map that must remain around a rover's origin, and around people
FFT_MULTIPLE = 48  # transforms of multiples of 2^4 * 3 are fast


@dataclass(frozen=True, eq=False)
class Heightfield:
    """Heights in metres, shape (rows, columns), `cell` metres apart."""

    heights: Field
    cell: float
    middle: tuple[float, float] = (0.0, 0.0)  # of the map, in the world: x, y [m]

    @property
    def half_size(self) -> tuple[float, float]:
        """Half the lengths of the map along x and y [m]."""
        rows, columns = self.heights.shape
        return 0.5 * self.cell * (columns - 1), 0.5 * self.cell * (rows - 1)

    def describe(self) -> str:
        """Returns the lengths of the map, and how many heights it has."""
        (half_x, half_y), (rows, columns) = self.half_size, self.heights.shape
        return (
            f"{2 * half_x:.4g} m along x, {2 * half_y:.4g} m along y, {columns} x {rows} heights "
            f"{self.cell:.4g} m apart"
        )

    def height_at(self, x: float, y: float) -> float:
        """Returns the height of the surface [m] at a point, which is clamped to the map.

        As `heights_at`, to the bit, without numpy's calls: a world asks for hundreds of points.
        """
        rows, columns = self.heights.shape
        (half_x, half_y), (middle_x, middle_y) = self.half_size, self.middle
        u = min(max((x - middle_x + half_x) / self.cell, 0.0), columns - 1.0)
        v = min(max((y - middle_y + half_y) / self.cell, 0.0), rows - 1.0)
        col, row = min(int(u), columns - 2), min(int(v), rows - 2)
        du, dv, at = u - col, v - row, self.heights.item
        near, far = at(row, col), at(row + 1, col + 1)
        corner = at(row, col + 1) if du >= dv else at(row + 1, col)
        low, high = min(du, dv), max(du, dv)
        height: float = near + (corner - near) * (high - low) + (far - near) * low
        return height

    def heights_at(self, x: Field | float, y: Field | float) -> Field:
        """Returns the heights of the surface [m] at points, which are clamped to the map."""
        rows, columns = self.heights.shape
        (half_x, half_y), (middle_x, middle_y) = self.half_size, self.middle
        u = np.clip((x - middle_x + half_x) / self.cell, 0.0, columns - 1.0)
        v = np.clip((y - middle_y + half_y) / self.cell, 0.0, rows - 1.0)
        col = np.minimum(u.astype(np.int64), columns - 2)
        row = np.minimum(v.astype(np.int64), rows - 2)
        du, dv = u - col, v - row
        right = du >= dv  # of the two triangles of the cell
        near, far = self.heights[row, col], self.heights[row + 1, col + 1]
        corner = self.heights[np.where(right, row, row + 1), np.where(right, col + 1, col)]
        low, high = np.minimum(du, dv), np.maximum(du, dv)
        return np.asarray(near + (corner - near) * (high - low) + (far - near) * low)

    def contains(self, x: float, y: float, margin: float = 0.0) -> bool:
        """Returns whether a point is on the map.

        Args:
            x: In the world [m].
            y: In the world [m].
            margin: How far within the edge [m].
        """
        (half_x, half_y), (middle_x, middle_y) = self.half_size, self.middle
        return abs(x - middle_x) < half_x - margin and abs(y - middle_y) < half_y - margin

    def bounds(self, margin: float = 0.0) -> tuple[float, float, float, float]:
        """Returns x from, x to, y from, y to [m] of the map without a margin along its edge."""
        (half_x, half_y), (x, y) = self.half_size, self.middle
        return x - half_x + margin, x + half_x - margin, y - half_y + margin, y + half_y - margin

    def check_place(self, what: str, x: float, y: float, margin: float = EDGE_MARGIN) -> None:
        """Raises UsageError, which says what it is and tells the map, if a place [m] is off it."""
        if not self.contains(x, y, margin):
            left, right, low, high = self.bounds(margin)
            edge = " or at its edge" * (margin > 0.0)
            raise UsageError(
                f"{what} {x:.4g},{y:.4g} is off the map{edge}; give x between {left:g} and "
                f"{right:g} m, y between {low:g} and {high:g} m"
            )


def finest_cell(width: float, depth: float) -> float:
    """Returns the smallest cells [m] that a map of a size [m] can have."""
    return math.sqrt(width * depth) / (math.sqrt(MOST_VERTICES) - 1)


def finer(ground: Heightfield, parts: int) -> Heightfield:
    """Returns the same surface with each cell divided into `parts` along either side."""
    rows, columns = ground.heights.shape
    left, right, low, high = ground.bounds()
    x = np.linspace(left, right, parts * (columns - 1) + 1)
    y = np.linspace(low, high, parts * (rows - 1) + 1)
    return Heightfield(
        ground.heights_at(*np.meshgrid(x, y, sparse=True)), ground.cell / parts, ground.middle
    )


def fractal(
    rng: np.random.Generator,
    shape: tuple[int, ...],
    *,
    cell: float,
    longest: float,
    shortest: float,
    hurst: float = 0.8,
    seamless: bool = False,
) -> Field:
    """Returns an isotropic random field of zero mean and unit RMS with a power-law spectrum.

    Args:
        rng: Source of randomness.
        shape: Vertices per row and column; square.
        cell: Vertex spacing [m].
        longest: Wavelength [m] above which the spectrum is flat.
        shortest: Wavelength [m] below which it fades out.
        hurst: Spectral density falls as frequency to the power of -2 (hurst + 1); more is smoother.
        seamless: Whether it repeats at its edges.
    """
    n = shape[0] if seamless else math.ceil(1.25 * shape[0] / FFT_MULTIPLE) * FFT_MULTIPLE
    amplitudes = _amplitudes(n, cell, longest, shortest, hurst)
    spectrum = np.fft.rfft2(rng.standard_normal((n, n))) * amplitudes
    field = np.fft.irfft2(spectrum, s=(n, n))[: shape[0], : shape[1]]  # the whole of it is periodic
    field -= field.mean()
    return np.asarray(field / field.std())


@lru_cache(maxsize=4)  # the worlds of a matrix, or of an environment, differ in their random numbers
def _amplitudes(n: int, cell: float, longest: float, shortest: float, hurst: float) -> Field:
    """What white noise of n x n vertices is multiplied by, shape (n, n // 2 + 1)."""
    frequency = np.hypot(np.fft.fftfreq(n, cell)[:, None], np.fft.rfftfreq(n, cell))
    amplitudes = (frequency**2 + longest**-2) ** (-0.5 * (hurst + 1))
    amplitudes *= np.exp(-0.5 * (frequency * shortest) ** 2)
    return np.asarray(amplitudes)


def smoothstep(value: Field, start: float, end: float) -> Field:
    """Returns 0 up to `start`, 1 from `end` on, without a kink in between.

    Args:
        value: Any numbers.
        start: Below `end`, in the unit of `value`.
        end: Above `start`, in the unit of `value`.
    """
    t = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def filled(values: Field) -> Field:
    """Returns the raster with missing values (NaN) replaced by a smooth surface through the rest.

    Means over blocks of 2 x 2, recursively, until no gap is left; then back down (a pull-push pyramid).
    """
    missing = np.isnan(values)
    if not missing.any():
        return values
    rows, columns = values.shape
    even = np.pad(values, ((0, rows % 2), (0, columns % 2)), constant_values=np.nan)
    blocks = even.reshape(even.shape[0] // 2, 2, even.shape[1] // 2, 2)
    known = (~np.isnan(blocks)).sum(axis=(1, 3))
    sums = np.nansum(blocks, axis=(1, 3))
    coarse = filled(np.where(known > 0, sums / np.maximum(known, 1), np.nan))
    # A block's middle lies between its pixels.
    return np.where(missing, _bilinear(coarse, (0.5, 0.5), (-0.25, -0.25), values.shape), values)


def resampled(values: Field, step: tuple[float, float], shape: tuple[int, int]) -> Field:
    """Returns values on a grid in the middle of another one.

    Where the new grid is coarser, means are taken first, so that no roughness turns into hills.

    Args:
        values: Shape (rows, columns).
        step: Distance of the new points in rows and in columns.
        shape: New rows and columns.
    """
    from scipy.ndimage import uniform_filter  # noqa: PLC0415 - 0.1 s that named terrains save

    widths = [2 * (round(stride) // 2) + 1 for stride in step]  # odd
    first = [
        0.5 * (size - 1) - 0.5 * stride * (count - 1)
        for size, stride, count in zip(values.shape, step, shape, strict=True)
    ]
    return _bilinear(uniform_filter(values, widths, mode="nearest"), step, first, shape)


def _bilinear(
    values: Field, step: Sequence[float], first: Sequence[float], shape: tuple[int, ...]
) -> Field:
    """Field on another grid; positions beyond the edge take the edge's value."""
    from scipy.ndimage import affine_transform  # noqa: PLC0415 - 0.1 s that named terrains save

    return np.asarray(affine_transform(values, step, first, shape, order=1, mode="nearest"))
