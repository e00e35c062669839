"""What a journey adds up, against raw positions of the rover and raw angles of its wheels."""

import math

import numpy as np
import pytest

from harness.robots import ROVERS
from harness.validate.grounds import floor
from harness.validate.rig import Rig
from harness.validate.square import Journey


@pytest.mark.parametrize("robot", ROVERS)
def test_a_journey_adds_up_the_true_way_and_the_one_that_the_wheels_believe(robot: str) -> None:
    rover = ROVERS[robot]
    rig = Rig(rover, floor(1))
    data, start, turned = rig.simulation.data, rig.stance, []
    journey, places, yaws = Journey(rig), [rig.simulation.position[:2]], [rig.simulation.yaw]
    angles = [rig.joint_angles(rover.wheel_joints)]
    rig.observers += [
        lambda: places.append(rig.simulation.position[:2]),
        lambda: yaws.append(rig.simulation.yaw),
        lambda: turned.append(float(data.qvel[5]) * 0.01),
    ]
    for speed, rate, seconds in ((0.4, 0.0, 2.0), (0.0, 1.0, 8.0), (-0.3, 0.0, 1.0), (0.0, 0.0, 0.5)):
        rig.command(speed, rate)
        rig.run(seconds)
        angles.append(rig.joint_angles(rover.wheel_joints))
    steps = np.diff(places, axis=0)
    along = np.column_stack([np.cos(yaws[:-1]), np.sin(yaws[:-1])])
    assert journey.true_path == pytest.approx((steps * along).sum())
    assert journey.true_yaw == pytest.approx(sum(turned), rel=0.01)
    assert journey.true_yaw > 2.0
    c, s = math.cos(rig.heading), math.sin(rig.heading)
    moved = np.array([[c, s], [-s, c]]) @ steps.sum(axis=0)
    assert (journey.true_place.real, journey.true_place.imag) == pytest.approx(moved, abs=1e-9)
    assert rig.stance.yaw - start.yaw == journey.true_yaw
    left, right = np.split((angles[-1] - angles[0]) * rover.controller_radius, 2)
    assert journey.stated_path == pytest.approx((left.mean() + right.mean()) / 2, abs=0.005)
    turn = (right.mean() - left.mean()) / rover.controller_separation
    assert journey.stated_yaw == pytest.approx(turn, rel=0.01)
    assert abs(journey.stated_place) > 0.1
