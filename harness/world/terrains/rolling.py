"""Rolling hills without anything small: slow pitch and roll, long wavelengths."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field, fractal
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter


@dataclass(frozen=True, kw_only=True)
class Rolling(Terrain):
    """Smooth hills and hollows.

    Attributes:
        relief: RMS height [m].
        wavelength: Distance from hill to hill [m].
    """

    name: ClassVar[str] = "rolling"
    summary: ClassVar[str] = "smooth hills and hollows of several metres"
    promise: ClassVar[Promise] = Promise(
        slope_p50=(5.0, 8.0),
        slope_p95=(11.0, 17.0),
        rms_1m=(0.005, 0.011),
        rms_03m=(0.0, 0.001),
    )

    relief: float = parameter(0.08, 0.2, 0.4, "m")
    wavelength: float = constant(8.0, "m")

    def heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        """Hills of the given relief [m]."""
        hills = fractal(
            rng,
            x.shape,
            cell=self.cell,
            longest=self.wavelength,
            shortest=0.5 * self.wavelength,
            hurst=1.5,
        )
        return self.relief * hills
