"""Where a mount is, against the sites of the model: MuJoCo's own state."""

import mujoco
import numpy as np
import pytest

from harness.frames.rover_frames import rover_frames
from tests.harness.conftest import MakeSimulation


@pytest.mark.parametrize(("frame", "site"), [("lidar_link", "lidar"), ("imu_frame", "imu")])
def test_a_mount_goes_with_its_body_however_that_is_turned(
    make_simulation: MakeSimulation, frame: str, site: str
) -> None:
    simulation = make_simulation("leo")
    model, data = simulation.model, simulation.data
    mount = rover_frames(simulation.scene.rover).mount(frame, model)
    for quaternion in np.random.default_rng(0).normal(size=(3, 4)):
        data.qpos[:7] = [1.0, -2.0, 0.5, *(quaternion / np.linalg.norm(quaternion))]
        mujoco.mj_kinematics(model, data)
        index = model.site(site).id
        expected = np.vstack([data.site_xpos[index], data.site_xmat[index].reshape(3, 3)])
        assert mount.pose(data) == pytest.approx(expected, abs=1e-9)
