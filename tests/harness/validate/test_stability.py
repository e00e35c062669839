"""Rigid-body statics against raw MuJoCo and against forces solved for one by one."""

import math

import numpy as np
import pytest

from harness.robots import ROVERS, RoverSpec
from harness.validate.climbing import kerb_limit
from harness.validate.grounds import floor
from harness.validate.rig import Rig
from harness.validate.stability import Balance, balance, steepest_stand, tip_angle


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
def test_the_balance_is_where_the_masses_are(rover: RoverSpec) -> None:
    rig = Rig(rover, floor(1))
    model, data = rig.simulation.model, rig.simulation.data
    ours = balance(rig)

    moving = model.body_mass > 0.0
    center = np.average(data.xipos[moving], axis=0, weights=model.body_mass[moving])
    wheels = np.array([data.xpos[model.joint(name).bodyid[0]] for name in rig.rover.wheel_joints])
    forward = np.array([math.cos(rig.simulation.yaw), math.sin(rig.simulation.yaw)])
    left = np.array([-forward[1], forward[0]])
    offset = wheels[:, :2] - center[:2]
    ahead, aside = offset @ forward, offset @ left
    arms = (ahead[[0, 2]], -ahead[[1, 3]], aside[[0, 1]], -aside[[2, 3]])
    assert tuple(ours.arms.values()) == pytest.approx([arm.mean() for arm in arms], abs=2.5e-3)
    assert ours.height == pytest.approx(center[2], abs=4e-3)  # above a floor at zero
    tips = min(math.atan(ROVERS[rig.rover.name].wheel_friction), math.atan2(ours.rear, ours.height))
    assert (steepest_stand(ours), tip_angle(0.3, 0.1)) == pytest.approx((tips, math.atan(3.0)))
    short = Balance(height=0.1, front=9.0, rear=0.05, left=9.0, right=9.0)
    assert steepest_stand(short) == pytest.approx(math.atan(0.5))


def climbs(height: float, rover: RoverSpec, stand: Balance) -> bool:
    """Whether the front wheels, on top, need no more than mu = 1 while the rear ones pull at it.

    Solved for the two forces at the front and the normal force at the rear edge.
    """
    radius, pitch = rover.wheel_radius, math.asin(height / rover.wheelbase)
    turn = np.array([[math.cos(pitch), -math.sin(pitch)], [math.sin(pitch), math.cos(pitch)]])
    rear_axle = np.array([0.0, radius])
    front_axle = rear_axle + turn @ (rover.wheelbase, 0.0)
    mass = front_axle + turn @ (-stand.front, stand.height - radius)
    front = front_axle - (0.0, radius)
    edge = np.array([math.sqrt(radius**2 - (radius - height) ** 2), height])
    normal = (rear_axle - edge) / radius
    pull = normal + np.array([normal[1], -normal[0]])  # with friction at its limit, forwards

    def moment(point: np.ndarray, force: np.ndarray) -> float:
        return float(point[0] * force[1] - point[1] * force[0])

    up, forwards, weight = np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.array([0.0, -1.0])
    columns = [(*f, moment(p, f)) for p, f in ((front, up), (front, forwards), (edge, pull))]
    lift, drive, _ = np.linalg.solve(np.array(columns).T, -np.array([*weight, moment(mass, weight)]))
    return bool(abs(drive) <= lift)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_the_kerb_limit_is_the_highest_at_which_the_forces_balance(rover: RoverSpec) -> None:
    length = rover.wheelbase
    stand = Balance(0.4 * length, front=0.52 * length, rear=0.48 * length, left=0.18, right=0.18)

    limit = kerb_limit(rover, stand)

    assert 0.02 < limit < rover.wheel_radius
    assert climbs(limit, rover, stand)
    assert not climbs(limit + 0.001, rover, stand)
