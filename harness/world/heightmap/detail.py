"""Detail below the cells of a heightmap, as rough as a class of ISO 8608 says.

ISO 8608:2016 describes the profile along a line over the ground by its one-sided power spectral
density G(n) = G(n0) (n / n0)^-2 of spatial frequency n, n0 being 0.1 cycles a metre; each class has four
times the density of the one before. An isotropic surface whose profiles have it has the density
S(f) = G(n0) n0^2 / (4 f^3) over the plane of frequencies, since the integral of (1 + t^2)^(-3/2) is 2.
"""

import math

import numpy as np

from harness.base.streams import DETAIL, generator
from harness.spec.world import ROUGHNESS
from harness.world.heightfield import Field, Heightfield, finer

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
