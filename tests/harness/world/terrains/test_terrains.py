"""What every named terrain owes."""

from collections.abc import Callable
from dataclasses import astuple
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from harness.world.statistics import measure, slopes
from harness.world.terrain import SPAWN_CLEARANCE, SPAWN_RADIUS
from harness.world.terrains import TERRAINS
from harness.world.world import World, build_world, terrain_hash

SEEDS = (0, 1, 2, 123)
ROUNDING = 1e-6  # heights are whole micrometres
ALL = pytest.mark.parametrize("name", TERRAINS)
DIFFICULTIES = pytest.mark.parametrize("difficulty", [0.0, 0.5, 1.0])

world_of = cache(build_world)


@ALL
def test_the_same_seed_makes_the_same_world(name: str) -> None:
    assert terrain_hash(build_world(name, 5)) == terrain_hash(build_world(name, 5))


@ALL
def test_another_seed_makes_another_world_unless_it_is_flat(name: str) -> None:
    hashes = {terrain_hash(world_of(name, seed)) for seed in SEEDS}
    assert len(hashes) == (1 if name == "flat" else len(SEEDS))


@ALL
@pytest.mark.parametrize("seed", SEEDS)
def test_it_keeps_its_promise(name: str, seed: int) -> None:
    world = world_of(name, seed)
    measured = measure(world.ground, world.obstacles)
    assert TERRAINS[name].promise.broken(measured) == [], measured


@ALL
def test_no_statistic_falls_with_difficulty_and_one_rises_unless_it_is_flat(name: str) -> None:
    worlds = [build_world(name, 4, d) for d in (0.0, 0.25, 0.5, 0.75, 1.0)]
    measured = [np.array(astuple(measure(w.ground, w.obstacles))) for w in worlds]
    for easier, harder in pairwise(measured):
        assert (harder >= easier - ROUNDING).all()
        assert (harder > easier).any() or name == "flat"


@ALL
@DIFFICULTIES
def test_the_ground_is_finite_and_as_large_as_it_says(name: str, difficulty: float) -> None:
    ground = world_of(name, 1, difficulty).ground
    assert np.isfinite(ground.heights).all()
    assert 2.0 * ground.half_size == pytest.approx(TERRAINS[name]().size)


@ALL
@DIFFICULTIES
def test_the_spawn_is_gentle(name: str, difficulty: float) -> None:
    terrain, ground = TERRAINS[name], world_of(name, 1, difficulty).ground
    axis = np.linspace(-ground.half_size, ground.half_size, len(ground.heights))
    near = np.hypot(*np.meshgrid(axis, axis)) <= SPAWN_RADIUS - ground.cell
    steepest = slopes(ground)[near].max()
    assert steepest == 0.0 if terrain.has_level_spawn else steepest < 24.0


@ALL
@DIFFICULTIES
def test_no_obstacle_stands_near_the_spawn(
    name: str, difficulty: float, spawn_distances: Callable[[World], list[float]]
) -> None:
    for seed in SEEDS:
        distances = spawn_distances(world_of(name, seed, difficulty))
        assert min(distances, default=np.inf) >= SPAWN_CLEARANCE


@ALL
@DIFFICULTIES
def test_obstacles_stand_inside_the_map(name: str, difficulty: float) -> None:
    world = world_of(name, 1, difficulty)
    for obstacle in world.obstacles:
        axis_aligned = obstacle.quaternion == (1.0, 0.0, 0.0, 0.0)
        half = np.array(obstacle.half_size[:2])
        reach = np.abs(obstacle.position[:2]) + (half if axis_aligned else np.linalg.norm(half))
        assert reach.max() < world.ground.half_size - 0.5


@ALL
def test_every_obstacle_touches_the_ground(name: str) -> None:
    world = world_of(name, 1, 1.0)
    for obstacle in world.obstacles:
        x, y, z = obstacle.position
        ground = world.ground.height_at(x, y)
        assert z - obstacle.half_size[-1] <= ground + 1e-9
        assert z + obstacle.half_size[-1] > ground


@ALL
def test_it_is_listed_with_a_summary_and_units(name: str) -> None:
    terrain = TERRAINS[name]
    assert terrain.name == name
    assert 10 < len(terrain.summary) < 80
    assert terrain.describe().startswith("size ")
    assert "deg" in terrain.promise.describe()
