import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Form, ObstacleKind, orientation, place, scatter


def test_scattered_points_keep_their_distance_from_each_other_spawn_and_edge() -> None:
    points = scatter(np.random.default_rng(1), 80, reach=9.0, spacing=1.2, keep_out=2.0)
    gaps = np.hypot(*(points[:, None] - points[None]).transpose(2, 0, 1))
    assert len(points) == 80
    assert gaps[~np.eye(80, dtype=bool)].min() >= 1.2
    assert np.hypot(*points.T).min() >= 2.0
    assert 8.0 < np.abs(points).max() <= 9.0


def test_scatter_fills_all_four_quadrants() -> None:
    points = scatter(np.random.default_rng(1), 80, reach=9.0, spacing=0.5, keep_out=1.0)
    quadrants = {(x > 0, y > 0) for x, y in points.tolist()}
    assert len(quadrants) == 4


def test_scatter_gives_up_where_there_is_no_room() -> None:
    points = scatter(np.random.default_rng(1), 50, reach=1.0, spacing=1.0, keep_out=0.5)
    assert 1 <= len(points) < 10


def test_scatter_of_nothing_is_an_empty_list_of_points() -> None:
    assert scatter(np.random.default_rng(1), 0, reach=1.0, spacing=1.0, keep_out=0.5).shape == (0, 2)


@pytest.mark.parametrize("kind", ObstacleKind)
def test_a_placed_form_stands_on_the_ground_sunk_turned_and_tilted_as_told(kind: ObstacleKind) -> None:
    y, x = np.mgrid[-2:3, -2:3]
    ground = Heightfield(2.0 + 0.1 * x + 0.3 * y, cell=1.0)
    form = Form(kind=kind, shape="cylinder", half_size=(0.1, 0.5), sink=0.2, yaw=0.7, tilt=0.3)
    obstacle = place(form, ground, 1.0, -1.0)
    assert obstacle.position == pytest.approx((1.0, -1.0, 1.8 + 0.5 - 0.2))
    assert (obstacle.kind, obstacle.shape, obstacle.half_size) == (kind, "cylinder", (0.1, 0.5))
    turn = Rotation.from_euler("ZX", (0.7, 0.3))  # about z, then about its own x
    assert obstacle.quaternion == pytest.approx(turn.as_quat(scalar_first=True))


def test_what_is_upright_is_not_turned() -> None:
    assert orientation(0.0) == (1.0, 0.0, 0.0, 0.0)
