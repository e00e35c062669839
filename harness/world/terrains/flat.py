"""Flat ground: the reference on which a rover's own behaviour shows."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from harness.world.fields import Field
from harness.world.statistics import Promise
from harness.world.terrain import Terrain


@dataclass(frozen=True, kw_only=True)
class Flat(Terrain):
    """A level plane; neither seed nor difficulty changes it."""

    name: ClassVar[str] = "flat"
    summary: ClassVar[str] = "level plane, the same for every seed and difficulty"
    promise: ClassVar[Promise] = Promise()

    def heights(self, x: Field, _y: Field, _rng: np.random.Generator, /) -> Field:
        """Zero everywhere [m]."""
        return np.zeros_like(x)
