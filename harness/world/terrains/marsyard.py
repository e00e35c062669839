"""A Mars yard like those of the European Rover Challenge: a soft plain with craters and hills.

Sized after the ERC Marsyard DEMs of 2021 and 2022 (slope p50 8-13 deg, p95 30-40 deg, RMS residual
over 1 m 29-39 mm, over 0.3 m about 6 mm): a dominant hill, hillocks, two large craters, smaller
pits, and 0.1 m cells.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial, reduce

import numpy as np

from harness.world.heightfield import Field, fractal, smoothstep
from harness.world.obstacles import Points, scatter
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter

RING = (11.0, 15.0)  # [m] from the origin to the large features
HILL_RADIUS, HILLOCK_RADIUS = 8.5, 3.5  # [m]
CRATER_RADII = (5.0, 3.6, 2.2)  # [m]
RIM = 0.25  # height of a crater's or pit's rim, relative to its depth
PIT_RADIUS, PIT_SPACING, PIT_KEEP_OUT = 1.0, 3.0, 5.5  # [m]
FEATURES = 6
OUTLINE_NOISE = 0.12  # relative: no feature is a perfect circle

Profile = Callable[[Field], Field]  # unit height over the distance from a centre [m]


@dataclass(frozen=True, kw_only=True)
class Marsyard(Terrain):
    """A plain with hills, craters and pits, none of them at the spawn."""

    name = "marsyard"
    summary = "like the European Rover Challenge: plain, steep hills, craters, pits"
    promise = Promise(
        slope_p50=(8.0, 13.0), slope_p95=(30.0, 40.0), rms_1m=(0.029, 0.039), rms_03m=(0.005, 0.007)
    )

    size: float = constant(48.0, "m")
    # height of the dominant hill [m]; hillocks have half of it
    hill: float = parameter(1.5, 3.6, 4.5, "m")
    # depth of the largest crater [m]; the smaller ones are shallower in proportion
    crater: float = parameter(0.5, 1.2, 1.6, "m")
    pits: int = constant(16, "")  # number of small pits, `pit` deep [m]
    pit: float = parameter(0.15, 0.3, 0.4, "m")
    relief: float = parameter(0.08, 0.16, 0.24, "m")  # RMS height of the plain [m]
    roughness: float = parameter(0.018, 0.036, 0.050, "m")  # RMS of the fine roughness [m]

    def _heights(self, x: Field, y: Field, rng: np.random.Generator, /) -> Field:
        plain_rng, rough_rng, outline_rng, feature_rng = rng.spawn(4)
        plain = fractal(plain_rng, x.shape, cell=self.cell, longest=10.0, shortest=2.5)
        rough = fractal(rough_rng, x.shape, cell=self.cell, longest=2.5, shortest=0.35)
        outline = fractal(outline_rng, x.shape, cell=self.cell, longest=8.0, shortest=4.0)
        stretch = 1.0 + OUTLINE_NOISE * outline
        heights = self.relief * plain + self.roughness * rough
        for (x0, y0), (scale, profile) in zip(
            _ring(feature_rng), self._features(feature_rng), strict=True
        ):
            heights += scale * profile(np.hypot(x - x0, y - y0) * stretch)
        return heights + self._pitted(x, y, feature_rng)

    def _features(self, rng: np.random.Generator) -> list[tuple[float, Profile]]:
        """Height or depth [m] and shape of the large features, in random order."""
        hillock = (0.5 * self.hill, partial(hill, radius=HILLOCK_RADIUS))
        features: list[tuple[float, Profile]] = [
            (self.hill, partial(hill, radius=HILL_RADIUS)),
            *(hillock, hillock),
            *(
                (self.crater * radius / CRATER_RADII[0], partial(crater, radius=radius))
                for radius in CRATER_RADII
            ),
        ]
        return [features[i] for i in rng.permutation(len(features))]

    def _pitted(self, x: Field, y: Field, rng: np.random.Generator) -> Field:
        """The small pits alone [m]."""
        centres = scatter(
            rng, self.pits, reach=0.4 * self.size, spacing=PIT_SPACING, keep_out=PIT_KEEP_OUT
        )
        distances = (np.hypot(x - x0, y - y0) for x0, y0 in centres)
        to_nearest: Field = reduce(np.minimum, distances)
        return np.asarray(self.pit * crater(to_nearest, PIT_RADIUS))


def hill(distance: Field, radius: float) -> Field:
    """Returns a rounded hill of unit height, by distance from its top [m]; zero from `radius` on."""
    return 1.0 - smoothstep(distance, 0.0, radius)


def crater(distance: Field, radius: float) -> Field:
    """Returns a bowl of unit depth, its inner half level, with a rim that ends at twice the radius."""
    bowl = (1.0 + RIM) * smoothstep(distance, 0.5 * radius, radius) - 1.0
    return np.asarray(bowl - RIM * smoothstep(distance, radius, 2.0 * radius))


def _ring(rng: np.random.Generator) -> Points:
    """Centres [m] all around the origin, so that none meets the spawn or covers its neighbour."""
    steps = np.arange(FEATURES) + rng.uniform() + rng.uniform(0.0, 0.3, FEATURES)
    angles = 2.0 * np.pi * steps / FEATURES
    distances = rng.uniform(*RING, FEATURES)
    return np.stack([distances * np.cos(angles), distances * np.sin(angles)], axis=1)
