"""What a parked rover does, against raw states of MuJoCo; what drives is as the model says."""

import math
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from harness.physics.parking import ParkingHold
from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from tests.harness.conftest import MakeSimulation

BOTH = pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS)
STANDING = np.zeros(4)


def tilt(simulation: Simulation, degrees: float, uphill: float) -> None:
    """Gravity, as on a slope that rises in a direction [rad]."""
    incline = math.radians(degrees)
    across = math.sin(incline) * np.array([math.cos(uphill), math.sin(uphill)])
    simulation.model.opt.gravity[:] = [*(-9.8 * across), -9.8 * math.cos(incline)]


def crept(simulation: Simulation, seconds: float) -> float:
    """Way of the origin [m], after half a second in which the load shifts."""
    for _ in range(50):
        simulation.tick()
    before = simulation.data.qpos[:3].copy()
    for _ in range(round(100 * seconds)):
        simulation.tick()
    return float(np.linalg.norm(simulation.data.qpos[:3] - before))


@BOTH
@pytest.mark.parametrize("uphill", [0.0, 2.4])
def test_a_parked_rover_creeps_less_than_a_millimetre_a_second_on_twenty_degrees(
    rover: RoverSpec, uphill: float, simulate: MakeSimulation
) -> None:
    simulation = simulate(rover)
    tilt(simulation, 20.0, uphill)
    simulation.command_wheels(STANDING)
    assert crept(simulation, 1.0) < 0.4e-3
    # One wheel that is to turn, and it drives: friction and servos yield as they do under way.
    simulation.command_wheels(np.array([0.0, 0.0, 0.0, 1e-9]))
    assert crept(simulation, 1.0) > 5e-3


def friction_of(model: mujoco.MjModel) -> list[float]:
    return [float(model.opt.impratio), *model.dof_frictionloss, *model.dof_solimp.ravel()]


@BOTH
def test_what_drives_again_is_to_the_bit_as_it_was(rover: RoverSpec, simulate: MakeSimulation) -> None:
    simulation = simulate(rover)
    parked = friction_of(simulation.model)
    simulation.command_wheels(np.ones(4))
    driving = friction_of(simulation.model)
    assert driving == friction_of(mujoco.MjModel.from_xml_path(str(rover.model_path)))
    assert driving != parked
    simulation.return_to_start()
    assert friction_of(simulation.model) == parked


def test_a_model_that_is_stiffer_than_a_parked_rover_stays_so() -> None:
    leo = ROVERS["leo"]
    model = mujoco.MjModel.from_xml_path(str(leo.model_path))
    model.opt.impratio = 200.0
    hold = ParkingHold(model, leo.wheel_joints, set())
    for holds in (True, False):
        hold.hold(holds)
        assert model.opt.impratio == 200.0


def test_who_only_steers_is_parked(
    foreign: Callable[[str], RoverSpec], simulate: MakeSimulation
) -> None:
    simulation = simulate(foreign("buggy"))
    stiff = []
    for speeds, angles in (((1.0, 1.0), (0.0, 0.0)), ((0.0, 0.0), (0.3, 0.2)), ((0.0, 0.1), (0.0, 0.0))):
        simulation.command_wheels(np.array([*speeds, *angles]))
        assert simulation.data.ctrl[simulation.motors].tolist() == [*speeds, *angles]
        stiff.append(simulation.model.opt.impratio)
    assert stiff == [1.0, 30.0, 1.0]
