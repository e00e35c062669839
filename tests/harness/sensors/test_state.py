"""Pose, true odometry and joint states against MuJoCo's own account of a state written by hand.

And the IMU: means over a window, its mounting, what it reads on a slope; how often people are told of.
"""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.physics.simulation import Simulation
from harness.sensors.state import (
    ImuSensor,
    PeopleSensor,
)
from tests.support.rovers import LEO

MakeSimulation = Callable[..., Simulation]


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
