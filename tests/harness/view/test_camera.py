from pathlib import Path

import numpy as np

from harness.episode.episode import Episode
from harness.physics.scene import build_scene
from harness.view.camera import best_view, chase_view
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO


def test_best_view_shows_the_path_and_stands_over_the_ground(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    world = CONFIG.world()
    episode = Episode(CONFIG)
    model = build_scene(world, LEO, 0.0025).model
    view = best_view(model, episode.simulation.data, states.path, states.yaw[-1], 0.7)
    assert view.sees(states.path, 0.7).all()
    assert view.eye[2] > world.ground.height_at(*view.eye[:2])


def test_chase_view_looks_where_the_rover_heads() -> None:
    view = chase_view(np.zeros(3), 0.0)
    assert view.direction[0] > 0.7
    assert view.eye[0] < 0.0 < view.eye[2]
