"""Dunes: gentle windward sides, steep lee sides below the angle of repose, crests along y."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field, fractal, smoothstep
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter


@dataclass(frozen=True, kw_only=True)
class Dunes(Terrain):
    """Rows of transverse dunes that bend, swell and fade; the wind blows along +x.

    Attributes:
        height: Typical height from trough to crest [m].
        wavelength: Distance from crest to crest [m].
        lee: Fraction of the wavelength that the lee side takes.
        meander: RMS shift of the crests along x [m].
    """

    name: ClassVar[str] = "dunes"
    summary: ClassVar[str] = "transverse dunes, gentle to windward and steep to leeward"
    promise: ClassVar[Promise] = Promise(
        slope_p50=(6.0, 8.0),
        slope_p95=(14.0, 19.0),
        rms_1m=(0.007, 0.012),
        rms_03m=(0.0, 0.001),
    )

    height: float = parameter(0.2, 0.45, 0.56, "m")
    wavelength: float = constant(7.0, "m")
    lee: float = constant(0.36, "")
    meander: float = constant(1.0, "m")

    def heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        """Dunes above the level of their troughs [m]."""
        bend, swell = (
            fractal(rng, x.shape, cell=self.cell, longest=20.0, shortest=10.0, hurst=1.5)
            for _ in range(2)
        )
        start = rng.uniform(0.0, self.wavelength)
        phase = ((x + start + self.meander * bend) / self.wavelength) % 1.0
        windward = 1.0 - self.lee
        profile = smoothstep(phase, 0.0, windward) - smoothstep(phase, windward, 1.0)
        return self.height * (1.0 + 0.25 * np.clip(swell, -2.0, 1.0)) * profile
