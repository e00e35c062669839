"""The simulation against MuJoCo stepped beside it, and against scipy's rotations."""

import math
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from harness.base.errors import Diverged, RunFailed
from harness.episode.assembly import world_of
from harness.physics.scene import build_scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.spec.run import Run

TICK_NS = 10_000_000
SPEEDS = np.array([1.0, 2.0, 3.0, 4.0])  # [rad/s] of the wheels, all different
Make = Callable[..., Simulation]


@pytest.fixture
def simulation(make_simulation: Make) -> Simulation:
    return make_simulation()


@pytest.mark.parametrize("seed", range(4))
def test_attitude_and_velocity_are_those_of_the_model_frame(seed: int, simulation: Simulation) -> None:
    rng = np.random.default_rng(seed)
    attitude = Rotation.random(random_state=seed)
    x, y, z, w = attitude.as_quat()
    position, velocity = rng.normal(size=3), rng.normal(size=3)
    simulation.data.qpos[:7] = *position, w, x, y, z
    simulation.data.qvel[:3] = velocity
    assert simulation.position == tuple(position)
    assert simulation.orientation == (x, y, z, w)
    ahead = attitude.apply([1.0, 0.0, 0.0])
    assert simulation.yaw == pytest.approx(math.atan2(ahead[1], ahead[0]))
    assert simulation.rotation() == pytest.approx(attitude.as_matrix())
    assert simulation.velocity == pytest.approx(attitude.inv().apply(velocity))


@pytest.mark.parametrize("robot", ROVERS)
def test_it_begins_at_rest_on_the_ground_at_time_zero(robot: str, make_simulation: Make) -> None:
    simulation = make_simulation(robot, heights=np.full((41, 41), 0.7))
    height = 0.7 + ROVERS[robot].rest_height
    assert simulation.position == pytest.approx((0.0, 0.0, height), abs=0.004)
    assert (simulation.time_ns, simulation.data.time) == (0, 0.0)
    assert np.abs(simulation.data.qvel).max() < 2e-3
    assert simulation.data.ncon >= 4
    assert not simulation.contacts.strongest


def test_back_at_its_start_it_drives_as_at_first_while_time_goes_on(simulation: Simulation) -> None:
    drives = []
    for _ in range(2):
        simulation.command_wheels(SPEEDS)
        drive = []
        for _ in range(5):
            simulation.tick()
            drive.append((simulation.data.qpos.tolist(), simulation.tick_sum.tolist()))
        drives.append(drive)
        simulation.return_to_start()
        assert not simulation.tick_sum.any()
    assert drives[0] == drives[1]
    assert simulation.time_ns == 10 * TICK_NS


@pytest.mark.parametrize(
    ("warning", "quantity"),
    [
        (mujoco.mjtWarning.mjWARN_BADQPOS, "position"),
        (mujoco.mjtWarning.mjWARN_BADQVEL, "velocity"),
        (mujoco.mjtWarning.mjWARN_BADQACC, "acceleration"),
        (mujoco.mjtWarning.mjWARN_BADCTRL, "wheel command"),
    ],
)
def test_a_diverged_state_ends_the_run_and_is_described(
    warning: mujoco.mjtWarning, quantity: str, simulation: Simulation
) -> None:
    simulation.tick()
    simulation.data.qpos[:3], simulation.data.qvel[:3] = (0.5, -0.25, 1.0), 0.0
    simulation.data.warning[warning].number = 1
    expected = rf"t = 0\.02 s \(NaN, infinite or huge {quantity}\); position \[0\.5, -0\.25, "
    with pytest.raises(Diverged, match=expected + r".* m, velocity \[.*, -0\.0\d+\] m/s; try"):
        simulation.tick()


@pytest.mark.parametrize("number", range(int(mujoco.mjtWarning.mjNWARNING)))
def test_whatever_mujoco_warns_of_ends_the_run(number: int, simulation: Simulation) -> None:
    simulation.data.warning[number].number = 1
    with pytest.raises(Diverged, match=r"; (try|enlarge|let) "):
        simulation.tick()


def test_a_divergence_leaves_no_file_of_mujocos_behind(
    make_simulation: Make, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    mujoco.set_mju_user_warning(None)  # as in a new process
    simulation = make_simulation()
    simulation.data.qvel[0] = math.nan
    with pytest.raises(Diverged):
        simulation.tick()
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_half_a_metre_before_the_edge_of_the_map_the_run_ends(
    axis: int, side: float, make_simulation: Make
) -> None:
    simulation, edge = make_simulation(heights=np.zeros((41, 61))), (2.5, 1.5)[axis]
    simulation.data.qpos[axis] = (edge - 0.02) * side
    simulation.tick()
    simulation.data.qpos[axis] = (edge + 0.02) * side
    place = ["0.00", "0.00"]
    place[axis] = f"{(edge + 0.02) * side:.2f}"
    with pytest.raises(
        RunFailed, match=rf"edge .* t = 0\.02 s \(x = -?{place[0]} m, y = -?{place[1]} m\)"
    ):
        simulation.tick()


@pytest.mark.parametrize("robot", ROVERS)
def test_a_rover_that_is_put_elsewhere_stands_there_on_the_ground_with_its_heading(robot: str) -> None:
    world = world_of(Run.of(terrain="rolling", seed=2))
    simulation = Simulation(build_scene(world, ROVERS[robot], 0.0025), 2_500_000)
    rest = simulation.position[2] - world.ground.height_at(*simulation.position[:2])
    simulation.command_wheels(SPEEDS)
    simulation.tick()
    steps = simulation.step_count
    simulation.put(3.0, -4.0, 2.0)
    x, y, z = simulation.position
    assert math.dist((x, y), (3.0, -4.0)) < 0.1
    assert math.remainder(simulation.yaw - 2.0, math.tau) == pytest.approx(0.0, abs=0.15)
    assert z - world.ground.height_at(x, y) == pytest.approx(rest, abs=0.08)
    assert np.abs(simulation.data.qvel[:6]).max() < 0.02
    assert simulation.step_count == steps
    assert not simulation.tick_sum.any()
    simulation.return_to_start()
    assert simulation.position[:2] == pytest.approx((0.0, 0.0), abs=0.1)
