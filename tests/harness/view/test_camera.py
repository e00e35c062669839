from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.episode.assembly import world_of
from harness.episode.episode import Episode
from harness.physics.scene import build_scene
from harness.view.camera import best_view
from tests.harness.view.recorded import CONFIG, recorded
from tests.support.rovers import LEO


def test_best_view_shows_the_path_and_stands_over_the_ground(tmp_path: Path) -> None:
    states = recorded(tmp_path / "states")
    world = world_of(CONFIG)
    episode = Episode(CONFIG)
    model = build_scene(world, LEO, 0.0025).model
    view = best_view(model, episode.simulation.data, states.path, states.yaw[-1], 0.7)
    assert view.sees(states.path, 0.7).all()
    assert view.eye[2] > world.ground.height_at(*view.eye[:2])


@pytest.mark.parametrize("wall", [0.0, 1.0])
def test_the_view_is_from_the_front_unless_something_stands_there(wall: float) -> None:
    """The rover heads to +y, where a wall of 2 m may stand before the camera."""
    box = f'<geom type="box" pos="0 {1.2 + 20 * (1 - wall)} 1" size="10 .1 1"/>'
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><geom type="plane" size="50 50 1"/>{box}</worldbody></mujoco>'
    )
    mujoco.mj_forward(model, data := mujoco.MjData(model))
    eye = best_view(model, data, np.zeros((1, 3)), np.pi / 2, 0.7).eye
    assert (eye[1] > 1.2) == (not wall)
