"""A camera's options and frames, what is wrong with them, and what its sample says."""

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.sensors.camera.sensor import VISIBLE_STATE, CameraOptions, CameraSensor
from tests.harness.sensors.installed import installation, simulation


def test_its_sample_is_the_scene_and_where_the_optical_frame_is() -> None:
    attitude, mounting = Rotation.from_quat((0.3, -0.4, 0.33, 0.8)), Rotation.from_euler("x", 0.4)
    rover = simulation((1.0, 2.0, 3.0), (0.8, 0.3, -0.4, 0.33))
    installed = installation(CameraOptions(name="eye"), xyz=(0.1, 0.2, 0.3), axes=mounting.as_matrix())
    state = CameraSensor(rover, installed, 10).read()
    assert (state.sensor, state.stamp_ns) == ("eye", 0)
    assert state.position == pytest.approx(np.add((1.0, 2.0, 3.0), attitude.apply((0.1, 0.2, 0.3))))
    turn = Rotation.from_quat(state.orientation).inv() * attitude * mounting
    assert turn.magnitude() == pytest.approx(0.0, abs=1e-9)
    kinds = mujoco.mjtState
    assert kinds.mjSTATE_QPOS | kinds.mjSTATE_MOCAP_POS | kinds.mjSTATE_MOCAP_QUAT == VISIBLE_STATE
    np.testing.assert_array_equal(state.state, rover.data.qpos)
