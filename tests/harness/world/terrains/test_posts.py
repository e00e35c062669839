import numpy as np
from scipy.spatial.distance import pdist

from harness.world.obstacles import ObstacleKind
from harness.world.world import build_world


def test_posts_and_cubes_have_the_sizes_of_the_inspection_worlds_over_the_ground() -> None:
    world = build_world("posts", 0)
    posts, cubes = world.obstacles[:32], world.obstacles[32:]
    assert len(cubes) == 12
    for obstacle in world.obstacles:
        x, y, z = obstacle.position
        half_x, half_y, half_z = obstacle.half_size
        shown = z + half_z - world.ground.height_at(x, y)
        if obstacle in posts:
            assert 0.05 <= half_x <= 0.15
            assert 0.05 <= half_y <= 0.1
            assert np.isclose(shown, 3.0)
        else:
            assert (half_x, half_y) == (0.25, 0.25)
            assert np.isclose(shown, 0.5)


def test_all_of_them_are_hazards_with_room_for_a_rover_between_them() -> None:
    obstacles = build_world("posts", 0, 1.0).obstacles
    assert {o.kind for o in obstacles} == {ObstacleKind.HAZARD}
    assert pdist([o.position[:2] for o in obstacles]).min() >= 2.0
