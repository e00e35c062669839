"""Gravel: smooth ground under a layer of stones of about a cell's size.

Independent steps of 30 mm from one 5 cm cell to the next stop a small rover (measured), so the
hardest gravel stays at 20 mm.
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field, fractal
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter


@dataclass(frozen=True, kw_only=True)
class Gravel(Terrain):
    """Gently uneven ground with gravel on it.

    Attributes:
        roughness: Standard deviation of the gravel from cell to cell [m].
        relief: RMS height of the ground below it [m].
    """

    name: ClassVar[str] = "gravel"
    summary: ClassVar[str] = "fine gravel on nearly level ground: shakes the IMU"
    promise: ClassVar[Promise] = Promise(
        slope_p50=(9.0, 10.0),
        slope_p95=(18.5, 20.5),
        rms_1m=(0.0095, 0.011),
        rms_03m=(0.0095, 0.0105),
    )

    cell: float = constant(0.05, "m")
    roughness: float = parameter(0.003, 0.010, 0.020, "m")
    relief: float = constant(0.05, "m")

    def heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        """Ground plus gravel [m]."""
        ground = fractal(rng, x.shape, cell=self.cell, longest=12.0, shortest=4.0)
        return self.relief * ground + self.roughness * rng.standard_normal(x.shape)
