"""Building blocks of terrains: height fields over a vertex grid, in metres or of unit size."""

import math

import numpy as np
from numpy.typing import NDArray

Field = NDArray[np.float64]

FFT_MULTIPLE = 48  # transforms of multiples of 2^4 * 3 are fast


def fractal(
    rng: np.random.Generator,
    shape: tuple[int, ...],
    *,
    cell: float,
    longest: float,
    shortest: float,
    hurst: float = 0.8,
) -> Field:
    """Isotropic random field of zero mean and unit RMS with a power-law spectrum.

    Args:
        rng: Source of randomness.
        shape: Vertices per row and column; square.
        cell: Vertex spacing [m].
        longest: Wavelength [m] above which the spectrum is flat.
        shortest: Wavelength [m] below which it fades out.
        hurst: Spectral density falls as frequency to the power of -2 (hurst + 1); more is smoother.
    """
    n = math.ceil(1.25 * shape[0] / FFT_MULTIPLE) * FFT_MULTIPLE  # cropped: no periodic edges
    field = _periodic(rng, n, cell, longest, shortest, hurst)[: shape[0], : shape[1]]
    return _of_unit_rms(field)


def unit_noise(
    rng: np.random.Generator, n: int, *, cell: float, longest: float, shortest: float, hurst: float
) -> Field:
    """Returns such a field of n x n vertices that repeats without seams; arguments as of `fractal`."""
    return _of_unit_rms(_periodic(rng, n, cell, longest, shortest, hurst))


def _periodic(
    rng: np.random.Generator, n: int, cell: float, longest: float, shortest: float, hurst: float
) -> Field:
    frequency = np.hypot(np.fft.fftfreq(n, cell)[:, None], np.fft.rfftfreq(n, cell))
    amplitude = (frequency**2 + longest**-2) ** (-0.5 * (hurst + 1))
    amplitude *= np.exp(-0.5 * (frequency * shortest) ** 2)
    spectrum = np.fft.rfft2(rng.standard_normal((n, n))) * amplitude
    return np.asarray(np.fft.irfft2(spectrum, s=(n, n)))


def _of_unit_rms(field: Field) -> Field:
    field -= field.mean()
    return np.asarray(field / field.std())


def smoothstep(value: Field, start: float, end: float) -> Field:
    """0 up to `start`, 1 from `end` on, without a kink in between; `start` < `end`."""
    t = np.clip((value - start) / (end - start), 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t))


def hill(distance: Field, radius: float) -> Field:
    """A rounded hill of unit height, by distance from its top [m]; zero from `radius` on."""
    return 1.0 - smoothstep(distance, 0.0, radius)


def crater(distance: Field, radius: float, rim: float) -> Field:
    """A bowl of unit depth with a raised rim, by distance from its centre [m].

    `radius` is that of the bowl [m], whose inner half is level; the rim's height is given as a
    fraction of the depth and fades out over as much again.
    """
    bowl = (1.0 + rim) * smoothstep(distance, 0.5 * radius, radius) - 1.0
    return np.asarray(bowl - rim * smoothstep(distance, radius, 2.0 * radius))


def levelled(heights: Field, distance: Field, inner: float, outer: float) -> Field:
    """Heights blended to their own mean within `inner`, untouched from `outer` on [m]."""
    level = heights[distance <= inner].mean()
    return np.asarray(level + (heights - level) * smoothstep(distance, inner, outer))
