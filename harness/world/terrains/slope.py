"""A ramp: one incline over the whole map, uphill along +x."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field, fractal
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter


@dataclass(frozen=True, kw_only=True)
class Slope(Terrain):
    """An inclined plane, the spawn included, roughened by a few millimetres.

    Attributes:
        incline: Angle of the plane about the y axis [deg].
        roughness: RMS of the roughness [m].
    """

    name: ClassVar[str] = "slope"
    summary: ClassVar[str] = "constant incline, uphill along +x, nearly smooth"
    promise: ClassVar[Promise] = Promise(
        slope_p50=(9.9, 10.1),
        slope_p95=(10.4, 10.9),
        rms_1m=(0.001, 0.002),
        rms_03m=(0.0, 0.001),
    )
    has_level_spawn: ClassVar[bool] = False

    incline: float = parameter(2.0, 10.0, 22.0, "deg")
    roughness: float = constant(0.002, "m")

    def heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        """The incline with its roughness [m]."""
        rough = fractal(rng, x.shape, cell=self.cell, longest=2.0, shortest=0.3)
        return x * math.tan(math.radians(self.incline)) + self.roughness * rough
