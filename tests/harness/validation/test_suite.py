"""The rovers pass, and rovers that were tampered with do not."""

from collections.abc import Callable

import mujoco
import pytest

from harness.physics.scene import Scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS, RoverSpec
from harness.validation import driving, rig, stability, standing
from harness.validation.check import Check
from harness.validation.suite import Manoeuvres
from tests.support.rovers import LEO

Tampering = Callable[[mujoco.MjModel], None]


@pytest.mark.parametrize("robot", ROVERS)
def test_every_check_of_the_suite_passes(robot: str, driven: dict[str, list[Check]]) -> None:
    assert [check for check in driven[robot] if not check.passed] == []


@pytest.mark.parametrize("robot", ROVERS)
def test_every_quantity_is_named_once_and_has_its_source(
    robot: str, driven: dict[str, list[Check]]
) -> None:
    names = [check.quantity for check in driven[robot]]
    assert len(set(names)) == len(names)
    assert all(check.expected.source for check in driven[robot])


def test_the_same_seed_measures_the_same_to_the_last_bit(driven: dict[str, list[Check]]) -> None:
    again = {check.quantity: check.measured for check in driving.checks(LEO, 0)}
    first = {check.quantity: check.measured for check in driven[LEO.name]}
    assert again == {name: first[name] for name in again}


def wheels(model: mujoco.MjModel) -> list[int]:
    return [g for g in range(model.ngeom) if model.geom(g).name.startswith("wheel_")]


def slippery(model: mujoco.MjModel) -> None:
    model.geom_friction[wheels(model), 0] = 0.6


def hard_contacts(model: mujoco.MjModel) -> None:
    model.geom_solimp[wheels(model)] = (0.9, 0.95, 0.001, 0.5, 2)


def weak_servos(model: mujoco.MjModel) -> None:
    model.actuator_gainprm[:, 0] = 4.0
    model.actuator_biasprm[:, 2] = -4.0


def stiff_rockers(model: mujoco.MjModel) -> None:
    model.jnt_range[model.joint("rocker_L_joint").id] = (-0.1, 0.1)


def low_belly(model: mujoco.MjModel) -> None:
    model.geom_pos[model.geom("body_chassis").id, 2] -= 0.02


def moon(model: mujoco.MjModel) -> None:
    model.opt.gravity[2] = -1.62


@pytest.mark.parametrize(
    ("tampering", "manoeuvres", "missed"),
    [
        (slippery, stability.checks, "slope held, nose up"),
        (hard_contacts, driving.checks, "sd of az turning in place, IMU at 100 Hz"),
        (weak_servos, driving.checks, "speed at 0.5 m/s commanded"),
        (stiff_rockers, standing.checks, "rocker angle at its stops"),
        (low_belly, standing.checks, "highest rock that passes below the underside"),
        (moon, standing.checks, "IMU at rest, |a|"),
    ],
)
def test_a_rover_that_was_tampered_with_is_found_out(
    tampering: Tampering, manoeuvres: Manoeuvres, missed: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def tampered(scene: Scene, timestep_ns: int) -> Simulation:
        tampering(scene.model)
        return Simulation(scene, timestep_ns)

    monkeypatch.setattr(rig, "Simulation", tampered)
    rover: RoverSpec = LEO
    check = next(check for check in manoeuvres(rover, 0) if check.quantity == missed)
    assert not check.passed
