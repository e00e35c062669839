"""Washboard: the ripples of an unpaved road, square to the first heading of the rover."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field, fractal
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter


@dataclass(frozen=True, kw_only=True)
class Washboard(Terrain):
    """Ripples with crests along y that meander and swell a little.

    Attributes:
        amplitude: Half the height from trough to crest [m].
        wavelength: Distance from crest to crest [m].
        meander: RMS shift of the crests along x [m].
    """

    name: ClassVar[str] = "washboard"
    summary: ClassVar[str] = "regular ripples across the way: excites pitch"
    promise: ClassVar[Promise] = Promise(
        slope_p50=(10.0, 12.0),
        slope_p95=(17.0, 20.0),
        rms_1m=(0.016, 0.019),
        rms_03m=(0.010, 0.013),
    )

    cell: float = constant(0.05, "m")
    amplitude: float = parameter(0.010, 0.025, 0.040, "m")
    wavelength: float = constant(0.5, "m")
    meander: float = constant(0.25, "m")

    def heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        """Ripples around zero [m]."""
        bend, swell = (
            fractal(rng, x.shape, cell=self.cell, longest=10.0, shortest=5.0) for _ in range(2)
        )
        phase = 2.0 * math.pi * (x + self.meander * bend) / self.wavelength
        return self.amplitude * (1.0 + 0.15 * np.clip(swell, -2.0, 2.0)) * np.sin(phase)
