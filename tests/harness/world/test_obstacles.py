import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.world.heightfield import Heightfield
from harness.world.obstacles import (
    Form,
    Obstacle,
    ObstacleKind,
    Shape,
    bottom,
    convex,
    half_extent,
    outline,
    place,
    rotation_matrix,
    scatter,
    top,
)
from harness.world.obstacles import surface as seen_only


def test_scattered_points_keep_their_distance_from_each_other_spawn_and_edge() -> None:
    points = scatter(np.random.default_rng(1), 80, reach=9.0, spacing=1.2, keep_out=2.0)
    gaps = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    assert len(points) == 80
    assert gaps[~np.eye(80, dtype=bool)].min() >= 1.2
    assert np.hypot(*points.T).min() >= 2.0
    assert 8.0 < np.abs(points).max() <= 9.0
    assert len(np.unique(points > 0.0, axis=0)) == 4
    assert len(scatter(np.random.default_rng(1), 50, reach=1.0, spacing=1.0, keep_out=0.5)) < 10


@pytest.mark.parametrize("kind", ObstacleKind)
def test_a_placed_form_stands_on_the_ground_sunk_turned_and_tilted(kind: ObstacleKind) -> None:
    y, x = np.mgrid[-2:3, -2:3]
    ground = Heightfield(2.0 + 0.1 * x + 0.3 * y, cell=1.0)
    form = Form(kind=kind, shape="cylinder", half_size=(0.1, 0.5), sink=0.2, yaw=0.7, tilt=0.3)
    obstacle = place(form, ground, 1.0, -1.0)
    assert obstacle.position == pytest.approx((1.0, -1.0, 1.8 + 0.5 - 0.2))
    assert (obstacle.kind, obstacle.shape, obstacle.half_size) == (kind, "cylinder", (0.1, 0.5))
    assert place(replace(form, yaw=0.0, tilt=0.0), ground, 1.0, -1.0).quaternion == (1.0, 0.0, 0.0, 0.0)
    turn = Rotation.from_euler("ZX", (0.7, 0.3))  # about z, then about its own x
    assert obstacle.quaternion == pytest.approx(turn.as_quat(scalar_first=True))


COS, SIN = math.cos(0.5), math.sin(0.5)  # rolled so far about x, then turned by 0.3 rad about z


@pytest.mark.parametrize(
    ("shape", "half", "reach", "rise"),
    [
        ("box", (0.5, 0.2, 0.8), 0.2 * COS + 0.8 * SIN, 0.2 * SIN + 0.8 * COS),
        (
            "ellipsoid",
            (0.5, 0.2, 0.8),
            math.hypot(0.2 * COS, 0.8 * SIN),
            math.hypot(0.2 * SIN, 0.8 * COS),
        ),
        ("cylinder", (0.3, 0.7), 0.3 * COS + 0.7 * SIN, 0.3 * SIN + 0.7 * COS),
    ],
)
def test_a_silhouette_reaches_as_far_as_the_body_in_every_direction(
    shape: Shape, half: tuple[float, ...], reach: float, rise: float
) -> None:
    turn = Rotation.from_euler("ZX", (0.3, 0.5))
    w, x, y, z = turn.as_quat(scalar_first=True).tolist()
    body = Obstacle(ObstacleKind.ROCK, shape, half, (3.0, -2.0, 1.0), (w, x, y, z))
    assert rotation_matrix(body.quaternion) == pytest.approx(turn.as_matrix())
    assert (top(body) - 1.0, 1.0 - bottom(body)) == pytest.approx((rise, rise))
    assert half_extent(body, 0.3) == pytest.approx(half[0])
    assert half_extent(body, 0.3 + math.pi / 2) == pytest.approx(reach)
    angles = np.arange(24) * math.tau / 24
    directions = np.column_stack([np.cos(angles), np.sin(angles)])
    farthest = np.array([half_extent(body, angle) for angle in angles])
    corners = outline(body) - (3.0, -2.0)
    assert (corners * directions).sum(axis=1) == pytest.approx(farthest, abs=1e-4)
    assert (corners @ directions.T <= farthest + 1e-4).all()


def test_a_hull_stands_in_the_middle_of_the_box_around_it_and_a_surface_has_its_triangles() -> None:
    points = np.array([[1.0, 0.0, 5.0], [1.5, 4.0, 5.0], [3.0, 1.0, 5.0], [1.0, 2.0, 8.0]])
    hull = convex(ObstacleKind.ROCK, points)
    assert (hull.position, hull.half_size) == ((2.0, 2.0, 6.5), (1.0, 2.0, 1.5))
    assert np.array(hull.corners) + hull.position == pytest.approx(points)
    assert (hull.kind, hull.shape, top(hull), bottom(hull)) == (ObstacleKind.ROCK, "convex", 8.0, 5.0)
    seen = seen_only(points, np.array([[0, 1, 3], [1, 2, 3]]))
    assert seen == replace(hull, kind=ObstacleKind.DECK, shape="surface", faces=((0, 1, 3), (1, 2, 3)))
