"""The shipped models have the numbers that models/README.md states, each with its source."""

import re

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.robots import ROVERS
from harness.robots.content import MODELS_DIR
from tests.support.rovers import LEO

NUMBER = re.compile(r"(?<![\w.])[-±]?\d+(?:\.\d+)?(?:e-?\d+)?")
README = (MODELS_DIR / "README.md").read_text(encoding="utf-8")
HEADINGS = {robot: f"## {robot}\n" for robot in ROVERS} | {
    robot: f"## {robot.title()}\n" for robot in ("leo", "husky", "jackal")
}


def stated(robot: str, quantity: str) -> list[float]:
    """The numbers in a row of the rover's table, without signs that mean both."""
    section = README.split(HEADINGS[robot])[1].split("\n## ")[0]
    (row,) = (line for line in section.splitlines() if line.startswith(f"| {quantity}"))
    cell = row.replace(r"\|", "").split("|")[2]
    return [float(number.lstrip("±")) for number in NUMBER.findall(cell)]


def inertia(model: mujoco.MjModel, body: str) -> NDArray[np.float64]:
    """xx, yy, zz, xy, xz, yz about the centre of mass, in the body's axes [kg m^2]."""
    axes = np.empty(9)
    mujoco.mju_quat2Mat(axes, model.body(body).iquat)
    rotation = axes.reshape(3, 3)
    tensor = rotation @ np.diag(model.body(body).inertia) @ rotation.T
    return tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


@pytest.mark.parametrize("robot", ROVERS)
def test_a_model_has_the_masses_joints_motors_and_sites_of_its_table(robot: str) -> None:
    rover = ROVERS[robot]
    model = mujoco.MjModel.from_xml_path(str(rover.model_path))
    assert model.body_mass.sum() == pytest.approx(stated(robot, "total mass")[0], abs=5e-4)
    mass, *centre = stated(robot, "body mass; centre")
    body = model.body("rover")
    assert (body.mass[0], *body.ipos) == pytest.approx((mass, *centre), abs=1e-5)
    products = stated(robot, "body inertia")  # of Leo all six, of rover_zero4wd xz alone, else none
    there = {6: [0, 1, 2, 3, 4, 5], 4: [0, 1, 2, 4], 3: [0, 1, 2]}[len(products)]
    assert inertia(model, "rover")[there] == pytest.approx(products, abs=1e-8)
    wheel_mass, *moments = stated(robot, "wheel mass")
    moments = stated(robot, "wheel inertia") if robot == "leo" else moments
    damping, friction, *_ = stated(robot, "wheel joint")
    torque, speed = stated(robot, "torque limit; speed limit")[:2]
    radius, width = stated(robot, "wheel radius, width")
    assert (rover.wheel_radius, rover.wheel_width) == (radius, width)
    for name in rover.wheel_joints:
        joint, motor = model.joint(name), model.actuator(name)
        wheel = model.body(model.joint(name).bodyid[0]).name
        assert model.body(wheel).mass[0] == pytest.approx(wheel_mass)
        assert inertia(model, wheel) == pytest.approx([*moments, 0.0, 0.0, 0.0], abs=1e-9)
        assert (joint.damping[0], joint.frictionloss[0]) == pytest.approx((damping, friction))
        assert [*motor.ctrlrange, *motor.forcerange] == [-speed, speed, -torque, torque]
        assert motor.gainprm[0] == stated(robot, "velocity gain kv")[0]
    for site, quantity in (("imu", "IMU"), ("lidar", "lidar |")):
        assert model.site(site).pos == pytest.approx(stated(robot, quantity)[:3])


@pytest.mark.parametrize(("side", "sign"), [("L", 1.0), ("R", -1.0)])
def test_leos_rockers_are_mirrored_but_for_their_products_of_inertia(side: str, sign: float) -> None:
    """The source turns the left rocker's frame by pi about z, which keeps xy and negates xz and yz."""
    model = mujoco.MjModel.from_xml_path(str(LEO.model_path))
    rocker, joint = model.body(f"rocker_{side}"), model.joint(f"rocker_{side}_joint")
    (mass, inboard, below), (x, y, z) = stated("leo", "rocker mass"), stated("leo", "rocker pivot")
    xx, yy, zz, xy, xz, yz = stated("leo", "rocker inertia")
    limit, damping, friction = stated("leo", "rocker joint")
    assert rocker.mass[0] == pytest.approx(mass)
    assert rocker.pos == pytest.approx([x, sign * y, z])
    assert 1e3 * rocker.ipos == pytest.approx([0, sign * -inboard, -below], abs=0.05)
    turned = [xx, yy, zz, xy, sign * xz, sign * -yz]
    assert inertia(model, f"rocker_{side}") == pytest.approx(turned, abs=1e-8)
    assert (*joint.range, joint.damping[0], joint.frictionloss[0]) == pytest.approx(
        (-limit, limit, damping, friction)
    )
