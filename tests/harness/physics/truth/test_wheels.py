"""The slip of wheels against closed forms and against small displacements of the whole rover."""

import math
from collections.abc import Callable

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.physics.simulation import Simulation
from harness.physics.truth.wheels import WheelMotion, Wheels, slip_ratio
from harness.robots import ROVERS, RoverSpec
from tests.support.rovers import LEO

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
RADIUS = {"leo": 0.0625, "rover_zero4wd": 0.127, "husky": 0.1651, "jackal": 0.098}

MakeSimulation = Callable[..., Simulation]


def motion(
    simulation: Simulation,
    wheel_speeds: float | tuple[float, ...],
    linear: tuple[float, float, float] = (0.0, 0.0, 0.0),
    angular: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> list[WheelMotion]:
    """For speeds of the wheels [rad/s] and the model frame, in the world [m/s] and in itself [rad/s]."""
    data, rover = simulation.data, simulation.scene.rover
    data.qvel[:] = 0.0
    data.qvel[:6] = *linear, *angular
    for name, speed in zip(rover.wheel_joints, np.broadcast_to(wheel_speeds, 4), strict=True):
        data.joint(name).qvel[0] = speed
    return Wheels(simulation).motion()


@BOTH
@pytest.mark.parametrize("seed", range(2))
def test_slip_is_that_of_a_small_displacement_in_any_attitude(
    rover: RoverSpec, seed: int, simulate: MakeSimulation
) -> None:
    """Each wheel's way and turn in a microsecond; bodies' poses are old when motion is asked for."""
    rng, moment = np.random.default_rng(seed), 1e-6
    simulation = simulate(rover)
    model, data = simulation.model, simulation.data
    data.qpos[:3] = rng.normal(size=3)
    data.qpos[3:7] = Rotation.random(rng=rng).as_quat(scalar_first=True)
    speeds, linear, angular = rng.uniform(-8, 8, 4), rng.normal(0, 0.5, 3), rng.normal(0, 1, 3)
    wheels = motion(simulation, tuple(speeds), tuple(linear), tuple(angular))
    now, then = mujoco.MjData(model), mujoco.MjData(model)
    now.qpos = then.qpos = data.qpos
    mujoco.mj_integratePos(model, then.qpos, data.qvel, moment)
    for moved in (now, then):
        mujoco.mj_kinematics(model, moved)
    axes = now.body("rover").xmat.reshape(3, 3)
    for name, wheel in zip(rover.wheel_joints, wheels, strict=True):
        body = int(model.joint(name).bodyid[0])
        forward, _, upward = (then.xpos[body] - now.xpos[body]) / moment @ axes
        before, after = (Rotation.from_matrix(d.xmat[body].reshape(3, 3)) for d in (now, then))
        turning = (after * before.inv()).as_rotvec() / moment @ axes[:, 1]
        ground = math.copysign(math.hypot(forward, upward), forward)
        rim = turning * RADIUS[rover.name]
        slip = np.clip((rim - ground) / max(abs(rim), abs(ground)), -1.0, 1.0)
        assert wheel.slip == pytest.approx(slip, abs=1e-5)
        assert (wheel.x, wheel.y) == pytest.approx(now.xpos[body][:2])
        assert wheel.moves


@pytest.mark.parametrize(
    ("speed", "moves"), [(0.05, True), (0.0499, False), (-0.05, True), (-0.0499, False)]
)
def test_a_wheel_moves_from_five_centimetres_a_second_at_its_rim_or_its_centre(
    speed: float, moves: bool, simulate: MakeSimulation
) -> None:
    simulation = simulate(LEO)
    simulation.data.qpos[3:7] = 1.0, 0.0, 0.0, 0.0
    for wheels in (motion(simulation, 16 * speed), motion(simulation, 0.0, (speed, 0.0, 0.0))):
        assert [wheel.moves for wheel in wheels] == [moves] * 4


def test_slip_ratio_is_positive_when_driving_and_negative_when_braking() -> None:
    wheels = (1.0, 1.0, 1.0, 0.0, 0.5, 1.0, -1.0, -1.0, 0.05, 0.0, 0.0499)
    ground = (1.0, 0.5, 0.0, 1.0, 1.0, -0.1, -0.5, 0.1, 0.0, 0.0499, 0.0)
    slips = [0.0, 0.5, 1.0, -1.0, -0.5, 1.0, -0.5, -1.0, 1.0, 0.0, 0.0]
    assert list(map(slip_ratio, wheels, ground)) == pytest.approx(slips)


def test_steered_wheels_that_roll_about_one_centre_do_not_slip(
    foreign: Callable[[str], RoverSpec], simulate: MakeSimulation
) -> None:
    """Put by hand onto a circle of 2 m: each wheel's speed is the yaw rate times its distance."""
    rover = foreign("buggy")
    simulation, radius, rate = simulate(rover), 2.0, 0.5
    data, (half, length, behind) = simulation.data, (0.2413 / 2, 0.3302, 0.17145)
    data.qpos[3:7] = 1.0, 0.0, 0.0, 0.0
    data.qvel[:] = 0.0
    data.qvel[[0, 1, 5]] = rate * radius, rate * behind, rate  # of the chassis, ahead of the axle
    for side, aside in (("left", half), ("right", -half)):
        data.joint(f"{side}_steering").qpos[0] = math.atan2(length, radius - aside)
        data.joint(f"rear_{side}_joint").qvel[0] = rate * (radius - aside) / 0.0508
        data.joint(f"front_{side}_joint").qvel[0] = rate * math.hypot(radius - aside, length) / 0.0508
    slips = [wheel.slip for wheel in Wheels(simulation).motion()]
    data.qvel[:6] = 0.5, 0.0, 0.0, 0.0, 0.0, 0.0  # straight ahead, across the steered wheels' planes
    for side in ("left", "right"):
        angle = data.joint(f"{side}_steering").qpos[0] = 0.4
        data.joint(f"rear_{side}_joint").qvel[0] = 0.5 / 0.0508
        data.joint(f"front_{side}_joint").qvel[0] = 0.5 * math.cos(angle) / 0.0508
    slips += [wheel.slip for wheel in Wheels(simulation).motion()]
    assert slips == pytest.approx([0.0] * 8, abs=1e-6)
