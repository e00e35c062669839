"""Rovers on bare ground: small worlds, and simulations whose state a test may write by hand."""

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from harness.robots import RoverSpec
from harness.sim_time import DEFAULT_TIMESTEP_NS, NANOSECONDS
from harness.simulation import Simulation
from harness.world.heightfield import Heightfield
from harness.world.scene import Scene, build_scene
from harness.world.world import World

HALF_SIZE, CELL = 4.0, 1.0  # [m]

MakeSimulation = Callable[..., Simulation]


@cache
def _scene(rover: RoverSpec, slope: float, timestep_ns: int) -> Scene:
    x = np.linspace(-HALF_SIZE, HALF_SIZE, round(2 * HALF_SIZE / CELL) + 1)
    heights = np.tile(math.tan(slope) * x, (len(x), 1))
    world = World("bare", Heightfield(heights, CELL), (), seed=0, difficulty=0.0)
    return build_scene(world, rover, timestep_ns / NANOSECONDS)


@pytest.fixture(scope="session")
def simulate() -> MakeSimulation:
    """Makes a settled simulation of a rover on flat ground, or on one that climbs along x [rad]."""

    def make(
        rover: RoverSpec, *, slope: float = 0.0, timestep_ns: int = DEFAULT_TIMESTEP_NS
    ) -> Simulation:
        scene = _scene(rover, slope, timestep_ns)
        return Simulation(replace(scene, model=copy.copy(scene.model)), timestep_ns)

    return make
