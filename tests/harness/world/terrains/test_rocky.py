from collections.abc import Callable

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.obstacles import ObstacleKind
from harness.world.terrains.rocky import Rocky
from harness.world.world import World, build_world

TopAt = Callable[[float, float], float]
ZERO_LIDAR, LEO_LIDAR = 0.323, 0.798  # [m] above the ground below the rover


def _shown(world: World, kind: ObstacleKind, top_at: TopAt) -> list[float]:
    """Heights over the ground [m] of all obstacles of a kind, at their centres."""
    places = [o.position[:2] for o in world.obstacles if o.kind is kind]
    return [top_at(x, y) - world.ground.height_at(x, y) for x, y in places]


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_rocks_are_many_and_low_enough_to_be_driven_over(
    seed: int, obstacle_top: Callable[[World], TopAt]
) -> None:
    world = build_world("rocky", seed)
    shown = _shown(world, ObstacleKind.ROCK, obstacle_top(world))
    assert 100 <= len(shown) <= 200
    assert min(shown) > 0.01
    assert max(shown) < 0.17
    assert sum(height < 0.07 for height in shown) / len(shown) > 0.7  # Leo's data sheet: 70 mm


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_all_boulders_are_seen_by_a_low_lidar_and_half_of_them_by_a_high_one(
    seed: int, obstacle_top: Callable[[World], TopAt]
) -> None:
    world = build_world("rocky", seed)
    shown = _shown(world, ObstacleKind.HAZARD, obstacle_top(world))
    assert len(shown) == 10
    assert min(shown) > ZERO_LIDAR + 0.1
    assert sum(height > LEO_LIDAR + 0.1 for height in shown) == 5


def test_boulders_leave_a_metre_more_than_their_reach_around_the_spawn_free() -> None:
    terrain, small = Rocky(rocks=0, boulders=4), Heightfield(np.zeros((81, 81)), 0.1)
    places = [
        boulder.position[:2]
        for seed in range(60)
        for boulder in terrain.obstacles(small, np.random.default_rng(seed))
    ]
    assert 3.1 <= np.hypot(*np.transpose(places)).min() < 3.11  # 1.5 m free, 0.6 m of reach


def test_rocks_are_ellipsoids_of_four_to_fifteen_centimetres() -> None:
    rocks = [o for o in build_world("rocky", 0).obstacles if o.kind is ObstacleKind.ROCK]
    assert {rock.shape for rock in rocks} == {"ellipsoid"}
    assert all(0.04 <= max(rock.half_size) <= 0.15 for rock in rocks)
