"""Pose, ground truth and joints against MuJoCo's own view of the same state."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.sensors.state import GroundTruthSensor, JointSensor, PoseSensor


@pytest.fixture(scope="module", params=ROVERS)
def tumbling(
    request: pytest.FixtureRequest, make_simulation: Callable[..., Simulation]
) -> tuple[Simulation, Rotation]:
    """A rover in mid-air, turning and driven; no two of its numbers are equal."""
    simulation = make_simulation(request.param)
    simulation.tick()
    rng, attitude = np.random.default_rng(7), Rotation.from_euler("ZYX", [2.0, 0.4, -0.3])
    data = simulation.data
    x, y, z, w = attitude.as_quat()
    data.qpos[:7] = 0.3, -0.2, 0.9, w, x, y, z
    data.qpos[7:] = rng.normal(size=len(data.qpos) - 7)
    data.qvel[:] = rng.normal(size=len(data.qvel))
    simulation.command_wheels(rng.normal(size=4))
    mujoco.mj_forward(simulation.model, data)
    return simulation, attitude


def test_the_pose_is_that_of_the_root_body(tumbling: tuple[Simulation, Rotation]) -> None:
    simulation, attitude = tumbling
    pose = PoseSensor(simulation, 2).read()
    assert pose.stamp_ns == 10_000_000
    assert pose.position == pytest.approx(simulation.data.body("rover").xpos)
    assert pose.orientation == pytest.approx(attitude.as_quat())


def test_ground_truth_is_the_planar_pose_and_the_velocity_in_the_body_frame(
    tumbling: tuple[Simulation, Rotation],
) -> None:
    simulation, _ = tumbling
    model, data = simulation.model, simulation.data
    twist = np.empty(6)  # angular, then linear, in the frame of the body
    body = model.body("rover").id
    mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, twist, 1)
    truth = GroundTruthSensor(simulation, 2).read()
    assert truth.stamp_ns == 10_000_000
    assert (truth.x, truth.y, truth.yaw) == pytest.approx((0.3, -0.2, 2.0))
    assert truth.angular_velocity == pytest.approx(twist[:3])
    assert truth.linear_velocity == pytest.approx(twist[3:])


def test_joints_tell_position_velocity_and_the_torque_of_their_motor(
    tumbling: tuple[Simulation, Rotation],
) -> None:
    simulation, _ = tumbling
    rover, data = simulation.scene.rover, simulation.data
    joints = JointSensor(simulation, 2).read()
    named = [data.joint(name) for name in (*rover.wheel_joints, *rover.passive_joints)]
    assert joints.stamp_ns == 10_000_000
    assert joints.position == tuple(float(joint.qpos[0]) for joint in named)
    assert joints.velocity == tuple(float(joint.qvel[0]) for joint in named)
    torques = [float(data.actuator(name).force[0]) for name in rover.wheel_joints]
    assert len(set(torques)) > 1
    assert joints.effort == pytest.approx((*torques, *(0.0 for _ in rover.passive_joints)))
