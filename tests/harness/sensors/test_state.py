"""Pose, true odometry and joint states against MuJoCo's own account of a state written by hand."""

import math
from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.sensors.state import GroundTruthSensor, JointSensor, PoseSensor
from tests.support.rovers import LEO

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
TORQUE_LIMIT, SERVO_GAIN = {"leo": 4.0, "rover_zero4wd": 7.0}, 20.0  # [N m], [N m s/rad]


@pytest.fixture(params=range(4), ids="state {}".format)
def thrown(request: pytest.FixtureRequest, simulate: Callable[..., Simulation]) -> Simulation:
    """A rover in the air, anyhow, moving and turning; bodies' poses are left where they were."""
    rng = np.random.default_rng(request.param)
    simulation = simulate(LEO)
    simulation.tick()
    simulation.data.qpos[:3] = rng.normal(size=3)
    simulation.data.qpos[3:7] = Rotation.random(rng=rng).as_quat(scalar_first=True)
    simulation.data.qvel[:] = rng.normal(size=simulation.model.nv)
    return simulation


def brought_up_to_date(simulation: Simulation) -> mujoco.MjData:
    data = mujoco.MjData(simulation.model)
    data.qpos, data.qvel = simulation.data.qpos, simulation.data.qvel
    mujoco.mj_forward(simulation.model, data)
    return data


def test_the_pose_is_that_of_the_model_frame(thrown: Simulation) -> None:
    pose = PoseSensor(thrown, 2).read()
    truth = brought_up_to_date(thrown).body("rover")
    assert pose.stamp_ns == 10_000_000
    assert not pose.empty
    assert pose.position == pytest.approx(truth.xpos)
    assert Rotation.from_quat(pose.orientation).as_matrix().ravel() == pytest.approx(truth.xmat)


def test_the_true_twist_is_in_the_model_frame_and_yaw_is_where_its_x_axis_points(
    thrown: Simulation,
) -> None:
    truth = GroundTruthSensor(thrown, 2).read()
    data, velocity = brought_up_to_date(thrown), np.empty(6)
    body = data.body("rover")
    local, frame = 1, mujoco.mjtObj.mjOBJ_XBODY
    mujoco.mj_objectVelocity(thrown.model, data, frame, body.id, velocity, local)
    assert truth.stamp_ns == 10_000_000
    assert (truth.x, truth.y) == pytest.approx(body.xpos[:2])
    ahead = body.xmat.reshape(3, 3)[:, 0]
    assert truth.yaw == pytest.approx(math.atan2(ahead[1], ahead[0]))
    assert truth.angular_velocity == pytest.approx(velocity[:3])
    assert truth.linear_velocity == pytest.approx(velocity[3:])


@BOTH
def test_joints_tell_angle_speed_and_the_motors_torque_which_is_none_where_there_is_no_motor(
    rover: RoverSpec, simulate: Callable[..., Simulation]
) -> None:
    """The motors are speed servos: torque = gain (commanded - actual speed), up to their limit."""
    simulation = simulate(rover)
    data, wheels = simulation.data, rover.wheel_joints
    commands, speeds = np.array([1.0, -2.0, 3.0, -4.0]), np.array([0.9, -2.15, 8.0, -9.0])
    for index, name in enumerate(rover.joints):
        data.joint(name).qpos[0] = 0.1 * index - 0.2
    for name, speed in zip(wheels, speeds, strict=True):
        data.joint(name).qvel[0] = speed
    for index, name in enumerate(rover.passive_joints):
        data.joint(name).qvel[0] = 0.3 + index
    simulation.command_wheels(commands)
    mujoco.mj_forward(simulation.model, data)
    simulation.step_count = 12
    limit = TORQUE_LIMIT[rover.name]
    torques = np.clip(SERVO_GAIN * (commands - speeds), -limit, limit)
    joints = JointSensor(simulation, 2).read()
    idle = len(rover.passive_joints)
    assert joints.stamp_ns == 30_000_000
    assert joints.position == pytest.approx([0.1 * n - 0.2 for n in range(4 + idle)])
    assert joints.velocity == pytest.approx([*speeds, *(0.3 + n for n in range(idle))])
    assert joints.effort == pytest.approx([*torques, *[0.0] * idle])
