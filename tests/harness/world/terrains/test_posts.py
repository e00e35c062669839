import numpy as np

from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import build_world


def _split(obstacles: tuple[Obstacle, ...]) -> tuple[list[Obstacle], list[Obstacle]]:
    posts = [o for o in obstacles if o.half_size[2] > 1.0]
    return posts, [o for o in obstacles if o not in posts]


def test_posts_and_cubes_have_the_sizes_of_the_inspection_worlds() -> None:
    posts, cubes = _split(build_world("posts", 0).obstacles)
    assert (len(posts), len(cubes)) == (32, 12)
    for post in posts:
        assert 0.1 <= 2 * post.half_size[0] <= 0.3
        assert 0.1 <= 2 * post.half_size[1] <= 0.2
    assert all(cube.half_size[:2] == (0.25, 0.25) for cube in cubes)


def test_they_stand_three_metres_and_half_a_metre_over_the_ground() -> None:
    world = build_world("posts", 0)
    for group, height in zip(_split(world.obstacles), (3.0, 0.5), strict=True):
        for obstacle in group:
            x, y, z = obstacle.position
            shown = z + obstacle.half_size[2] - world.ground.height_at(x, y)
            assert np.isclose(shown, height)


def test_all_of_them_are_hazards_with_room_for_a_rover_between_them() -> None:
    obstacles = build_world("posts", 0, 1.0).obstacles
    points = np.array([o.position[:2] for o in obstacles])
    gaps = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    assert {o.kind for o in obstacles} == {ObstacleKind.HAZARD}
    assert gaps[~np.eye(len(points), dtype=bool)].min() >= 2.0
