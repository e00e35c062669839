import pytest

from harness.world.obstacles import ObstacleKind, top
from harness.world.world import build_world

ZERO_LIDAR, LEO_LIDAR = 0.323, 0.798  # [m] above the ground below the rover


@pytest.mark.parametrize("seed", [0, 1])
def test_rocks_can_be_driven_over_and_boulders_are_seen_half_of_them_by_a_high_lidar_too(
    seed: int,
) -> None:
    world = build_world("rocky", seed)
    shown: dict[ObstacleKind, list[float]] = {ObstacleKind.ROCK: [], ObstacleKind.HAZARD: []}
    for obstacle in world.obstacles:
        x, y, _ = obstacle.position
        shown[obstacle.kind].append(top(obstacle) - world.ground.height_at(x, y))
        if obstacle.kind is ObstacleKind.ROCK:
            assert obstacle.shape == "ellipsoid"
            assert 0.04 <= max(obstacle.half_size) <= 0.15
    rocks, boulders = shown.values()
    assert 100 <= len(rocks) <= 200
    assert 0.01 < min(rocks) < max(rocks) < 0.17
    assert sum(height < 0.07 for height in rocks) / len(rocks) > 0.7  # Leo's data sheet: 70 mm
    assert len(boulders) == 10
    assert min(boulders) > ZERO_LIDAR + 0.1
    assert sum(height > LEO_LIDAR + 0.1 for height in boulders) == 5
