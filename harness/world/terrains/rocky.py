"""Rocky ground, the default world: drivable rocks everywhere and a few boulders to be avoided."""

from dataclasses import dataclass

import numpy as np

from harness.world.heightfield import Field, Heightfield, fractal
from harness.world.obstacles import Form, Obstacle, ObstacleKind, place, scatter
from harness.world.statistics import Promise
from harness.world.terrain import EDGE_CLEARANCE, SPAWN_CLEARANCE, Terrain, parameter

LARGEST_ROCK, LARGEST_BOULDER = 0.15, 0.6  # [m] horizontal reach from the centre
ROCK_SPACING, BOULDER_SPACING = 0.5, 3.0  # [m] between centres
BOULDER_TO_ROCK = 1.0  # [m] between centres


@dataclass(frozen=True, kw_only=True)
class Rocky(Terrain):
    """Gently rolling ground with partly buried rocks and some boulders."""

    name = "rocky"
    summary = "rolling ground, drivable rocks of 4-15 cm and a few boulders (default)"
    has_hazards = True
    promise = Promise(
        slope_p50=(4.0, 6.0),
        slope_p95=(8.5, 12.0),
        rms_1m=(0.007, 0.010),
        rms_03m=(0.0015, 0.0025),
        obstacle_density=(0.09, 0.10),
    )

    relief: float = parameter(0.06, 0.12, 0.25, "m")  # RMS height of the ground [m]
    roughness: float = parameter(0.003, 0.006, 0.010, "m")  # RMS of its fine roughness [m]
    rocks: int = parameter(80, 150, 300, "")  # number of drivable rocks, with semi-axes of 4-15 cm
    # number of hazards; every other one stands tall enough for a lidar 0.8 m up
    boulders: int = parameter(4, 10, 24, "")

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        ground = fractal(rng, x.shape, cell=self.cell, longest=10.0, shortest=3.0, hurst=1.0)
        rough = fractal(rng, x.shape, cell=self.cell, longest=1.0, shortest=0.3)
        return self.relief * ground + self.roughness * rough

    def obstacles(self, ground: Heightfield, rng: np.random.Generator, /) -> tuple[Obstacle, ...]:
        """Returns boulders first, then the rocks between them."""
        boulder_rng, rock_rng = rng.spawn(2)
        reach = min(ground.half_size) - EDGE_CLEARANCE
        boulders = scatter(
            boulder_rng,
            self.boulders,
            reach=reach - LARGEST_BOULDER,
            spacing=BOULDER_SPACING,
            keep_out=SPAWN_CLEARANCE + LARGEST_BOULDER + 1.0,
        )
        rocks = scatter(
            rock_rng,
            self.rocks,
            reach=reach - LARGEST_ROCK,
            spacing=ROCK_SPACING,
            keep_out=SPAWN_CLEARANCE + LARGEST_ROCK,
        )
        gaps = np.hypot(*(rocks[:, None] - boulders[None]).transpose(2, 0, 1))
        free = rocks[(gaps > BOULDER_TO_ROCK).all(axis=1)]
        return (
            *(
                place(_boulder(boulder_rng, tall=index % 2 == 0), ground, *point)
                for index, point in enumerate(boulders.tolist())
            ),
            *(place(_rock(rock_rng), ground, *point) for point in free.tolist()),
        )


def _rock(rng: np.random.Generator) -> Form:
    """An ellipsoid that shows a third to two thirds of its height; small ones are common."""
    length = 0.04 + (LARGEST_ROCK - 0.04) * rng.beta(1.2, 2.0)
    width, height = length * rng.uniform(0.65, 1.0), length * rng.uniform(0.5, 0.8)
    return Form(
        kind=ObstacleKind.ROCK,
        shape="ellipsoid",
        half_size=(length, width, height),
        sink=2.0 * height * rng.uniform(0.33, 0.6),
        yaw=rng.uniform(0.0, np.pi),
        tilt=rng.normal(0.0, 0.1),
    )


def _boulder(rng: np.random.Generator, *, tall: bool) -> Form:
    """A block that shows 0.95-1.3 m if tall, else a squat ellipsoid that shows 0.5-0.85 m."""
    if tall:
        half = (rng.uniform(0.25, 0.4), rng.uniform(0.2, 0.35))
        shown, sink = rng.uniform(0.95, 1.3), 0.15
    else:
        half = (rng.uniform(0.45, LARGEST_BOULDER), rng.uniform(0.35, 0.45))
        shown, sink = rng.uniform(0.5, 0.85), 0.3
    return Form(
        kind=ObstacleKind.HAZARD,
        shape="box" if tall else "ellipsoid",
        half_size=(*half, 0.5 * (shown + sink)),
        sink=sink,
        yaw=rng.uniform(0.0, np.pi),
        tilt=rng.uniform(-0.08, 0.08),
    )
