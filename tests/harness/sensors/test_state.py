"""Pose, true odometry and joint states against MuJoCo's own account of a state written by hand.

And the IMU: means over a window, its mounting, what it reads on a slope; how often people are told of.
"""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.sensors.state import (
    ImuSensor,
    JointSensor,
    PeopleSensor,
)
from tests.support.rovers import LEO

MakeSimulation = Callable[..., Simulation]

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
TORQUE_LIMIT = {"leo": 4.0, "rover_zero4wd": 7.0, "husky": 30.0, "jackal": 8.0}  # [N m]
SERVO_GAIN = {"leo": 20.0, "rover_zero4wd": 20.0, "husky": 400.0, "jackal": 50.0}  # [N m s/rad]


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
    simulation.physics.step_count = 12
    limit = TORQUE_LIMIT[rover.name]
    torques = np.clip(SERVO_GAIN[rover.name] * (commands - speeds), -limit, limit)
    joints = JointSensor(simulation, 2).read()
    idle = len(rover.passive_joints)
    assert joints.stamp_ns == 30_000_000
    assert joints.position == pytest.approx([0.1 * n - 0.2 for n in range(4 + idle)])
    assert joints.velocity == pytest.approx([*speeds, *(0.3 + n for n in range(idle))])
    assert joints.effort == pytest.approx([*torques, *[0.0] * idle])


@pytest.mark.parametrize(("timestep_ns", "steps"), [(2_500_000, 4), (5_000_000, 2)])
def test_a_reading_is_the_mean_over_every_step_since_the_last_one(
    simulate: MakeSimulation, timestep_ns: int, steps: int
) -> None:
    simulation = simulate(LEO, timestep_ns=timestep_ns)
    imu = ImuSensor(simulation, 5)
    rng = np.random.default_rng(1)
    for ticks in (1, 5, 3):
        force, rate = rng.normal(size=(2, ticks * steps, 3))
        for tick in range(ticks):
            of_tick = slice(tick * steps, (tick + 1) * steps)
            for name, values in (("imu_accelerometer", force), ("imu_gyro", rate)):
                start = int(simulation.model.sensor(name).adr[0])
                simulation.tick_sum[start : start + 3] = values[of_tick].sum(axis=0)
            imu.observe(simulation.tick_sum[None])
        reading = imu.read()
        assert reading.linear_acceleration == pytest.approx(force.mean(axis=0))
        assert reading.angular_velocity == pytest.approx(rate.mean(axis=0))
    for value in (70.0, steps):
        imu.after_reset()  # what is forgotten is never read
        simulation.tick_sum[:] = value
        imu.observe(simulation.tick_sum[None])
    reading = imu.read()
    assert reading.linear_acceleration == reading.angular_velocity == (1.0, 1.0, 1.0)


def test_orientation_is_that_of_the_mounted_sensor_in_the_world(simulate: MakeSimulation) -> None:
    for seed in range(5):
        R_world_model, R_model_imu = Rotation.random(2, rng=np.random.default_rng(seed))  # noqa: N806
        simulation = simulate(LEO)
        simulation.model.site("imu").quat[:] = R_model_imu.as_quat(scalar_first=True)
        imu = ImuSensor(simulation, 5)
        simulation.data.qpos[3:7] = R_world_model.as_quat(scalar_first=True)
        imu.observe(simulation.tick_sum[None])
        turn = Rotation.from_quat(imu.read().orientation).inv() * R_world_model * R_model_imu
        assert turn.magnitude() == pytest.approx(0.0, abs=1e-9)


def test_people_are_told_of_thirty_times_in_each_second(
    make_simulation: Callable[..., Simulation],
) -> None:
    simulation = make_simulation(actors=("g=1,1/1,-1", "x=0,1"))
    assert simulation.crowd is not None
    sensor = PeopleSensor(simulation, simulation.crowd)
    due = [tick for tick in range(1, 301) if sensor.due(tick)]
    assert len(due) == 90
    assert all(abs(tick / 100 - (n + 1) / 30) < 0.01 for n, tick in enumerate(due))
    simulation.tick()
    told = sensor.read()
    assert told.stamp_ns == simulation.time_ns
    assert np.array(told.position) == pytest.approx(np.array([[1.0, 0.99, 0.875], [0.0, 1.0, 0.875]]))
    half = np.sqrt(0.5)
    assert told.orientation[0] == pytest.approx((0.0, 0.0, -half, half))
