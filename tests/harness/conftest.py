"""Rovers on small grounds: compiled and settled fast, their state may be written by hand."""

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.base.sim_time import DEFAULT_TIMESTEP_NS, NANOSECONDS
from harness.physics.scene import Scene, build_scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.robots.urdf.folder import write_folder
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle
from harness.world.world import World, with_actors
from tests.support.foreign_rovers import FOREIGN
from tests.support.words import parse_actors

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
        actors: tuple[str, ...] = (),
        timestep_ns: int = TIMESTEP_NS,
    ) -> Simulation:
        ground = Heightfield(np.zeros((VERTICES, VERTICES)) if heights is None else heights, CELL)
        world = World("bench", ground, obstacles, seed=0, difficulty=0.0)
        world = with_actors(world, parse_actors(actors)) if actors else world
        return Simulation(build_scene(world, ROVERS[robot], timestep_ns / 1e9), timestep_ns)

    return make


SLOPE_HALF_SIZE, SLOPE_CELL = 4.0, 1.0  # [m]


@cache
def _scene(rover: RoverSpec, slope: float, timestep_ns: int) -> Scene:
    x = np.linspace(-SLOPE_HALF_SIZE, SLOPE_HALF_SIZE, round(2 * SLOPE_HALF_SIZE / SLOPE_CELL) + 1)
    heights = np.tile(math.tan(slope) * x, (len(x), 1))
    world = World("bare", Heightfield(heights, SLOPE_CELL), (), seed=0, difficulty=0.0)
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


@pytest.fixture(scope="session")
def foreign(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], RoverSpec]:
    """Makes the rover of that name that is not ours; the same folder for all who ask."""
    root = tmp_path_factory.mktemp("foreign")

    @cache
    def make(name: str) -> RoverSpec:
        urdf = Path(root / f"{name}.urdf")
        urdf.write_text(FOREIGN[name].urdf)
        return write_folder(name, urdf, root / name).rover

    return make
