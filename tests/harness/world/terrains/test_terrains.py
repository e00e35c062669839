"""What every named terrain owes."""

from dataclasses import asdict, astuple
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.ndimage import label

from harness.world.actors.free_space import from_wall
from harness.world.heightfield import Heightfield
from harness.world.obstacles import ObstacleKind, outline, top
from harness.world.statistics import slopes
from harness.world.terrain import SPAWN_CLEARANCE, SPAWN_RADIUS, Terrain
from harness.world.terrains import TERRAINS
from harness.world.terrains.maze import CHAMBERS, PITCH
from harness.world.world import World, build_world, terrain_hash
from tests.support.terrain_statistics import TerrainStatistics, measure

SEEDS = (0, 1, 123)
ROUNDING = 1e-6  # heights are whole micrometres
ALL = pytest.mark.parametrize("name", TERRAINS)
DIFFICULTIES = pytest.mark.parametrize("difficulty", [0.0, 0.5, 1.0])

_cached = cache(build_world)


def world_of(name: str, seed: int, difficulty: float = 0.5) -> World:
    """A world that several tests look at."""
    return _cached(name, seed, difficulty)


@cache
def measured(name: str, seed: int, difficulty: float) -> TerrainStatistics:
    """What is measured of a world."""
    world = world_of(name, seed, difficulty)
    return measure(world.ground, world.obstacles)


@ALL
def test_a_seed_makes_one_world_and_another_seed_another_unless_it_is_flat(name: str) -> None:
    assert terrain_hash(build_world(name, 1)) == terrain_hash(world_of(name, 1))
    hashes = {terrain_hash(world_of(name, seed)) for seed in SEEDS}
    assert len(hashes) == (1 if name == "flat" else len(SEEDS))


@ALL
@pytest.mark.parametrize("seed", SEEDS)
def test_it_keeps_its_promise(name: str, seed: int) -> None:
    found = measured(name, seed, 0.5)
    promised = asdict(TERRAINS[name].promise)
    broken = [key for key, (low, high) in promised.items() if not low <= getattr(found, key) <= high]
    assert broken == [], found


@ALL
def test_no_statistic_falls_with_difficulty_and_one_rises_unless_it_is_flat(name: str) -> None:
    for easier, harder in pairwise(np.array(astuple(measured(name, 1, d))) for d in (0.0, 0.5, 1.0)):
        assert (harder >= easier - ROUNDING).all()
        assert (harder > easier).any() or name == "flat"


@ALL
@DIFFICULTIES
def test_the_ground_is_as_large_as_it_says_and_gentle_at_the_spawn(name: str, difficulty: float) -> None:
    terrain, ground = TERRAINS[name], world_of(name, 1, difficulty).ground
    assert np.isfinite(ground.heights).all()
    assert ground.half_size == pytest.approx((terrain().size / 2,) * 2)
    axis = np.linspace(-ground.half_size[0], ground.half_size[0], len(ground.heights))
    near = np.hypot(*np.meshgrid(axis, axis)) <= SPAWN_RADIUS - ground.cell
    steepest = slopes(ground)[near].max()
    assert steepest == 0.0 if terrain.has_level_spawn else steepest < 24.0


@pytest.mark.parametrize(
    "name", [n for n, t in TERRAINS.items() if t.obstacles is not Terrain.obstacles]
)
def test_no_obstacle_stands_near_the_spawn(name: str) -> None:
    """On a map so small that some must stand as near as they may."""
    small, terrain = Heightfield(np.zeros((121, 121)), 0.1), TERRAINS[name].at_difficulty(0.0)
    nearest = min(
        float(from_wall(np.zeros((1, 2)), outline(obstacle))[0][0])
        for seed in range(30)
        for obstacle in terrain.obstacles(small, np.random.default_rng(seed))
    )
    assert SPAWN_CLEARANCE == 1.5 <= nearest
    assert nearest < 1.6 or name == "maze"


@ALL
@DIFFICULTIES
def test_obstacles_stand_inside_the_map_on_its_ground(name: str, difficulty: float) -> None:
    world = world_of(name, 1, difficulty)
    kinds = {obstacle.kind for obstacle in world.obstacles}
    assert (ObstacleKind.HAZARD in kinds) is TERRAINS[name].has_hazards
    for obstacle in world.obstacles:
        axis_aligned = obstacle.quaternion == (1.0, 0.0, 0.0, 0.0)
        half = np.array(obstacle.half_size[:2])
        reach = np.abs(obstacle.position[:2]) + (half if axis_aligned else np.linalg.norm(half))
        assert reach.max() < min(world.ground.half_size) - 0.5
        x, y, z = obstacle.position
        ground = world.ground.height_at(x, y)
        assert z - obstacle.half_size[-1] <= ground + 1e-9 < z + obstacle.half_size[-1]


# RMS of the heights about their mean, the height at 3, 2.5 [m], and a sum over the numbers of obstacles.
FIRST_RELEASE = {
    ("slope", 1.0): (4.676982, 1.209389, 0.0),
    ("rolling", 0.5): (0.19868, 0.438451, 0.0),
    ("gravel", 0.5): (0.050769, -0.100984, 0.0),
    ("rocky", 0.5): (0.11982, 0.124311, 2186.698),
    ("washboard", 0.5): (0.017684, 0.010459, 0.0),
    ("dunes", 0.5): (0.166038, 0.442626, 0.0),
    ("posts", 0.5): (0.049897, -0.035748, 1242.481),
    ("maze", 0.5): (0.0, 0.0, 496.2),
    ("marsyard", 0.5): (0.521665, 0.120853, 0.0),
}


@pytest.mark.parametrize(("name", "difficulty"), FIRST_RELEASE)
def test_a_seed_makes_the_world_that_it_has_made_since_the_first_release(
    name: str, difficulty: float
) -> None:
    """Recorded runs name their world by terrain, seed and difficulty: it must not move under them."""
    rms, height, total = FIRST_RELEASE[name, difficulty]
    world = world_of(name, 1, difficulty)
    numbers = [(*o.half_size, *o.position, *o.quaternion) for o in world.obstacles]
    found = world.ground.heights.std(), world.ground.height_at(3.0, 2.5)
    assert found == pytest.approx((rms, height), abs=2e-6)
    weighted = sum(n * value for row in numbers for n, value in enumerate(row, start=1))
    assert weighted == pytest.approx(total, abs=0.01)


@pytest.mark.parametrize(("seed", "difficulty"), [(0, 0.0), (1, 0.5), (2, 1.0)])
def test_a_rover_can_reach_every_chamber_of_a_maze_but_not_leave(seed: int, difficulty: float) -> None:
    """On a grid of 0.1 m, through passages of 1.2 m."""
    x, y = np.meshgrid(*[0.1 * np.arange(-120, 121)] * 2, indexing="ij")
    free = np.ones_like(x, dtype=bool)
    for wall in world_of("maze", seed, difficulty).obstacles:
        beyond_x = np.maximum(np.abs(x - wall.position[0]) - wall.half_size[0], 0.0)
        beyond_y = np.maximum(np.abs(y - wall.position[1]) - wall.half_size[1], 0.0)
        free &= np.hypot(beyond_x, beyond_y) > 0.6
    parts, _ = label(free)
    reached = parts == parts[120, 120]
    chambers = np.round((np.arange(CHAMBERS) - CHAMBERS // 2) * PITCH / 0.1).astype(int) + 120
    assert reached[np.ix_(chambers, chambers)].all()
    assert not reached[:15].any()
    assert not reached[:, -15:].any()


def test_rocks_can_be_driven_over_and_half_of_the_boulders_are_seen_by_a_high_lidar_too() -> None:
    world = world_of("rocky", 1)
    shown: dict[ObstacleKind, list[float]] = {ObstacleKind.ROCK: [], ObstacleKind.HAZARD: []}
    for obstacle in world.obstacles:
        height = top(obstacle) - world.ground.height_at(*obstacle.position[:2])
        shown[obstacle.kind].append(height)
    rocks, boulders = shown.values()
    assert (100 <= len(rocks) <= 200, len(boulders)) == (True, 10)
    assert 0.01 < min(rocks) < max(rocks) < 0.17
    assert sum(height < 0.07 for height in rocks) / len(rocks) > 0.7  # Leo's data sheet: 70 mm
    assert min(boulders) > 0.323 + 0.1  # of rover_zero4wd's lidar; Leo's is higher
    assert sum(height > 0.798 + 0.1 for height in boulders) == 5
