"""A rover on a small ground of the test's own: compiled and settled in a fifth of a second."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.physics.scene import build_scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.world import World

VERTICES, CELL = 41, 0.1  # the map is 4 m wide
TIMESTEP_NS = 2_500_000

MakeSimulation = Callable[..., Simulation]


@pytest.fixture(scope="session")
def make_simulation() -> MakeSimulation:
    """Builds a simulation of a rover at the middle of a map of 4 m."""

    def make(
        robot: str = "rover_zero4wd",
        *,
        heights: NDArray[np.float64] | None = None,
        obstacles: tuple[Obstacle, ...] = (),
        timestep_ns: int = TIMESTEP_NS,
    ) -> Simulation:
        ground = Heightfield(np.zeros((VERTICES, VERTICES)) if heights is None else heights, CELL)
        world = World("bench", ground, obstacles, seed=0, difficulty=0.0)
        return Simulation(build_scene(world, ROVERS[robot], timestep_ns / 1e9), timestep_ns)

    return make
