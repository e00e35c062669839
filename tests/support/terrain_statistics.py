"""What a world measures: the figures of which every terrain makes a promise."""

import math
from dataclasses import dataclass

import numpy as np

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.statistics import residuals, slopes


@dataclass(frozen=True, kw_only=True)
class TerrainStatistics:
    """Measured on a whole map; the fields are those of harness.world.statistics.Promise."""

    slope_p50: float
    slope_p95: float
    rms_1m: float
    rms_03m: float
    obstacle_density: float


def measure(ground: Heightfield, obstacles: tuple[Obstacle, ...] = ()) -> TerrainStatistics:
    """The figures of a world."""
    p50, p95 = np.percentile(slopes(ground), (50, 95))
    return TerrainStatistics(
        slope_p50=float(p50),
        slope_p95=float(p95),
        rms_1m=residual_rms(ground, 1.0),
        rms_03m=residual_rms(ground, 0.3),
        obstacle_density=len(obstacles) / (4.0 * math.prod(ground.half_size)),
    )


def residual_rms(ground: Heightfield, window: float) -> float:
    """RMS residual [m] over square windows of that side length [m]."""
    return float(np.sqrt(np.mean(residuals(ground, window) ** 2)))
