"""Posts: nearly level ground with slender posts and cubes, like RoboTerrain's inspection worlds.

Its inspection_boxes worlds hold posts of 0.1-0.3 x 0.1-0.2 x 3 m and cubes of 0.5 m.
"""

from dataclasses import dataclass

import numpy as np

from harness.world.heightfield import Field, Heightfield, fractal
from harness.world.obstacles import Form, Obstacle, ObstacleKind, place, scatter
from harness.world.statistics import Promise
from harness.world.terrain import EDGE_CLEARANCE, SPAWN_CLEARANCE, Terrain, constant, parameter

POST_HEIGHT, CUBE = 3.0, 0.5  # [m]
REACH = 0.36  # [m] from the centre of a cube to its corner, rounded up
SPACING = 2.0  # [m] between centres: wide enough for a rover
SINK = 0.05  # [m], so that no gap shows on uneven ground


@dataclass(frozen=True, kw_only=True)
class Posts(Terrain):
    """A slightly uneven field of hazards."""

    name = "posts"
    summary = "nearly level, with posts 3 m high and cubes of 0.5 m to be avoided"
    has_hazards = True
    promise = Promise(
        slope_p50=(1.5, 2.3),
        slope_p95=(3.2, 4.6),
        rms_1m=(0.002, 0.004),
        rms_03m=(0.0, 0.001),
        obstacle_density=(0.025, 0.03),
    )

    relief: float = constant(0.05, "m")  # RMS height of the ground [m]
    posts: int = parameter(12, 32, 80, "")  # number of posts 3 m high
    cubes: int = parameter(4, 12, 30, "")  # number of cubes of 0.5 m

    def _heights(self, x: Field, _y: Field, rng: np.random.Generator, /) -> Field:
        return self.relief * fractal(rng, x.shape, cell=self.cell, longest=12.0, shortest=3.0)

    def obstacles(self, ground: Heightfield, rng: np.random.Generator, /) -> tuple[Obstacle, ...]:
        """Returns posts and cubes, all of them hazards."""
        points = scatter(
            rng,
            self.posts + self.cubes,
            reach=min(ground.half_size) - EDGE_CLEARANCE - REACH,
            spacing=SPACING,
            keep_out=SPAWN_CLEARANCE + REACH,
        )
        return tuple(
            place(_block(rng, post=index < self.posts), ground, *point)
            for index, point in enumerate(points.tolist())
        )


def _block(rng: np.random.Generator, *, post: bool) -> Form:
    """A post or a cube."""
    half_size = (0.5 * CUBE, 0.5 * CUBE, 0.5 * (CUBE + SINK))
    if post:
        half_size = (rng.uniform(0.05, 0.15), rng.uniform(0.05, 0.1), 0.5 * (POST_HEIGHT + SINK))
    yaw = rng.uniform(0.0, np.pi)
    return Form(kind=ObstacleKind.HAZARD, shape="box", half_size=half_size, sink=SINK, yaw=yaw)
