"""Terrains of nothing but ground: flat, slope, rolling, gravel, washboard and dunes."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from harness.world.heightfield import Field, Heightfield, fractal, smoothstep
from harness.world.statistics import Promise
from harness.world.terrain import Terrain, constant, parameter

BARE = 0.12  # share of the dunes' height below which there is no sand


@dataclass(frozen=True, kw_only=True)
class Flat(Terrain):
    """A level plane, on which a rover's own behaviour shows; neither seed nor difficulty changes it."""

    name = "flat"
    summary = "level plane, the same for every seed and difficulty"
    promise = Promise()

    def _heights(self, x: Field, _y: Field, _rng: np.random.Generator, /) -> Field:
        return np.zeros_like(x)


@dataclass(frozen=True, kw_only=True)
class Slope(Terrain):
    """An inclined plane, the spawn included, roughened by a few millimetres."""

    name = "slope"
    summary = "constant incline, uphill along +x, nearly smooth"
    promise = Promise(
        slope_p50=(9.9, 10.1), slope_p95=(10.4, 10.9), rms_1m=(0.001, 0.002), rms_03m=(0.0, 0.001)
    )
    has_level_spawn = False

    incline: float = parameter(2.0, 10.0, 22.0, "deg")  # angle of the plane about the y axis [deg]
    roughness: float = constant(0.002, "m")  # RMS of the roughness [m]

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        rough = fractal(rng, x.shape, cell=self.cell, longest=2.0, shortest=0.3)
        return x * math.tan(math.radians(self.incline)) + self.roughness * rough


@dataclass(frozen=True, kw_only=True)
class Rolling(Terrain):
    """Hills and hollows without anything small: slow pitch and roll."""

    name = "rolling"
    summary = "smooth hills and hollows of several metres"
    promise = Promise(
        slope_p50=(5.0, 8.0), slope_p95=(11.0, 17.0), rms_1m=(0.005, 0.011), rms_03m=(0.0, 0.001)
    )

    relief: float = parameter(0.08, 0.2, 0.4, "m")  # RMS height [m]
    wavelength: float = constant(8.0, "m")  # distance from hill to hill [m]

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        longest, shortest = self.wavelength, 0.5 * self.wavelength
        hills = fractal(rng, x.shape, cell=self.cell, longest=longest, shortest=shortest, hurst=1.5)
        return self.relief * hills


@dataclass(frozen=True, kw_only=True)
class Gravel(Terrain):
    """Gently uneven ground under a layer of stones of about a cell's size.

    Independent steps of 30 mm from one 5 cm cell to the next stop a small rover (measured), so the
    hardest gravel stays at 20 mm.
    """

    name = "gravel"
    summary = "fine gravel on nearly level ground: shakes the IMU"
    promise = Promise(
        slope_p50=(9.0, 10.0), slope_p95=(18.5, 20.5), rms_1m=(0.0095, 0.011), rms_03m=(0.0095, 0.0105)
    )

    cell: float = constant(0.05, "m")
    # standard deviation of the gravel from cell to cell [m]
    roughness: float = parameter(0.003, 0.010, 0.020, "m")
    relief: float = constant(0.05, "m")  # RMS height of the ground below it [m]

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        ground = fractal(rng, x.shape, cell=self.cell, longest=12.0, shortest=4.0)
        return self.relief * ground + self.roughness * rng.standard_normal(x.shape)


@dataclass(frozen=True, kw_only=True)
class Washboard(Terrain):
    """The ripples of an unpaved road: crests along y that meander and swell a little."""

    name = "washboard"
    summary = "regular ripples across the way: excites pitch"
    promise = Promise(
        slope_p50=(10.0, 12.0), slope_p95=(17.0, 20.0), rms_1m=(0.016, 0.019), rms_03m=(0.010, 0.013)
    )

    cell: float = constant(0.05, "m")
    amplitude: float = parameter(0.010, 0.025, 0.040, "m")  # half the height from trough to crest [m]
    wavelength: float = constant(0.5, "m")  # distance from crest to crest [m]
    meander: float = constant(0.25, "m")  # RMS shift of the crests along x [m]

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        bend, swell = (
            fractal(rng, x.shape, cell=self.cell, longest=10.0, shortest=5.0) for _ in range(2)
        )
        phase = 2.0 * math.pi * (x + self.meander * bend) / self.wavelength
        return self.amplitude * (1.0 + 0.15 * np.clip(swell, -2.0, 2.0)) * np.sin(phase)


@dataclass(frozen=True, kw_only=True)
class Dunes(Terrain):
    """Rows of transverse dunes that bend, swell and fade; the wind blows along +x."""

    name = "dunes"
    summary = "transverse dunes, gentle to windward and steep to leeward"
    promise = Promise(
        slope_p50=(6.0, 8.0), slope_p95=(14.0, 19.0), rms_1m=(0.007, 0.012), rms_03m=(0.0, 0.001)
    )
    soils = ("firm", "dry_sand")

    height: float = parameter(0.2, 0.45, 0.56, "m")  # typical height from trough to crest [m]
    wavelength: float = constant(7.0, "m")  # distance from crest to crest [m]
    # fraction of the wavelength that the lee side takes; it stays below the angle of repose
    lee: float = constant(0.36, "")
    meander: float = constant(1.0, "m")  # RMS shift of the crests along x [m]

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
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

    @classmethod
    def patches(cls, ground: Heightfield) -> NDArray[np.uint8]:
        """Returns sand but for the troughs, where the ground below it lies bare."""
        heights = ground.heights
        sandy = heights > heights.min() + BARE * np.ptp(heights)
        return np.asarray(sandy, np.uint8)
