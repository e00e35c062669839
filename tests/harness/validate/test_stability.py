"""Rigid-body statics against raw MuJoCo and against forces solved for one by one."""

import math

import numpy as np
import pytest

from harness.robots import ROVERS, RoverSpec
from harness.validate.climbing import kerb_limit
from harness.validate.grounds import floor
from harness.validate.rig import Rig
from harness.validate.stability import (
    Balance,
    TiltTable,
    balance,
    steepest_stand,
    tip_angle,
)


@pytest.fixture(scope="module", params=list(ROVERS))
def rig(request: pytest.FixtureRequest) -> Rig:
    return Rig(ROVERS[request.param], floor(1))


def test_the_balance_is_where_the_masses_are(rig: Rig) -> None:
    model, data = rig.simulation.model, rig.simulation.data
    ours = balance(rig)

    moving = model.body_mass > 0.0
    center = np.average(data.xipos[moving], axis=0, weights=model.body_mass[moving])
    wheels = np.array([data.xpos[model.joint(name).bodyid[0]] for name in rig.rover.wheel_joints])
    forward = np.array([math.cos(rig.simulation.yaw), math.sin(rig.simulation.yaw)])
    left = np.array([-forward[1], forward[0]])
    offset = wheels[:, :2] - center[:2]
    ahead, aside = offset @ forward, offset @ left
    expected = Balance(
        weight=float(model.body_mass.sum()) * 9.8,
        height=float(center[2]),  # above a floor at zero
        front=float(ahead[[0, 2]].mean()),
        rear=-float(ahead[[1, 3]].mean()),
        left=float(aside[[0, 1]].mean()),
        right=-float(aside[[2, 3]].mean()),
    )
    for name in ("weight", "height", "front", "rear", "left", "right"):
        assert getattr(ours, name) == pytest.approx(getattr(expected, name), rel=1e-3, abs=2.5e-3), name
    assert ours.front + ours.rear == pytest.approx(rig.rover.wheelbase, abs=2e-3)


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

    up, forwards, weight = np.array([0.0, 1.0]), np.array([1.0, 0.0]), np.array([0.0, -stand.weight])
    columns = [(*f, moment(p, f)) for p, f in ((front, up), (front, forwards), (edge, pull))]
    lift, drive, _ = np.linalg.solve(np.array(columns).T, -np.array([*weight, moment(mass, weight)]))
    return bool(abs(drive) <= lift)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_the_kerb_limit_is_the_highest_at_which_the_forces_balance(rover: RoverSpec) -> None:
    stand = Balance(weight=50.0, height=0.12, front=0.15, rear=0.14, left=0.18, right=0.18)

    limit = kerb_limit(rover, stand)

    assert 0.02 < limit < rover.wheel_radius
    assert climbs(limit, rover, stand)
    assert not climbs(limit + 0.001, rover, stand)


@pytest.mark.parametrize(
    ("arm", "height", "tips", "stands"),
    [(0.3, 0.1, math.atan(3.0), math.radians(45)), (0.05, 0.1, math.atan(0.5), math.atan(0.5))],
)
def test_a_rover_tips_about_its_lower_wheels_unless_it_slides_before(
    arm: float, height: float, tips: float, stands: float
) -> None:
    stand = Balance(weight=1.0, height=height, front=9.0, rear=arm, left=9.0, right=9.0)
    assert tip_angle(arm, height) == pytest.approx(tips)
    assert steepest_stand(stand) == pytest.approx(stands)


@pytest.mark.parametrize("uphill", [0.0, 0.7, math.pi])
def test_the_table_tilts_gravity_as_the_ground_would_rise(rig: Rig, uphill: float) -> None:
    table = TiltTable(rig, uphill)
    try:
        table.tilt(math.radians(30.0))
        gravity = rig.simulation.model.opt.gravity.copy()
    finally:
        table.tilt(0.0)

    assert np.linalg.norm(gravity) == pytest.approx(9.8)
    assert gravity[2] == pytest.approx(-9.8 * math.cos(math.radians(30.0)))
    downhill = (-math.cos(uphill), -math.sin(uphill))
    assert gravity[:2] == pytest.approx(4.9 * np.array(downhill))
    assert rig.simulation.model.opt.gravity == pytest.approx((0.0, 0.0, -9.8))
