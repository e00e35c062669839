"""Several rovers in one model: whose contacts, whose parking, whose reset, whose failure."""

import math

import mujoco
import numpy as np
import pytest

from harness.base.errors import Diverged, RunFailed
from harness.physics.berths import Member
from harness.physics.scene import build_scene, build_scenes
from harness.physics.simulation import Simulation, simulations
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import World
from tests.support.rovers import LEO, ROVER_ZERO4WD

TIMESTEP_NS = 2_500_000
WALL = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 1.0, 0.5), (-0.6, 0.0, 0.3))
WORLD = World("bench", Heightfield(np.zeros((61, 61)), 0.1), (WALL,), seed=0, difficulty=0.0)
FLEET = (Member("a", LEO, (0.0, 0.0, 0.0)), Member("b", ROVER_ZERO4WD, (0.8, 0.1, 2.0)))


@pytest.fixture
def pair() -> tuple[Simulation, Simulation]:
    one, other = simulations(build_scenes(WORLD, FLEET, TIMESTEP_NS / 1e9), TIMESTEP_NS)
    return one, other


def own(simulation: Simulation) -> set[int]:
    """The geoms below a rover's root, walked by hand."""
    model, found = simulation.model, set()
    for geom in range(model.ngeom):
        body = int(model.geom_bodyid[geom])
        while body not in (0, simulation.scene.root):
            body = int(model.body_parentid[body])
        if body == simulation.scene.root:
            found.add(geom)
    return found


def touches(simulation: Simulation, of: set[int], others: set[int]) -> list[float]:
    """Normal forces between two sets of geoms, of MuJoCo's contacts as they are."""
    forces, force = [], np.zeros(6)
    for index, pair in enumerate(simulation.data.contact.geom.tolist()):
        if (set(pair) & of) and (set(pair) & others):
            mujoco.mj_contactForce(simulation.model, simulation.data, index, force)
            forces.append(float(force[0]))
    return forces


def test_models_of_other_options_are_joined_without_a_word(
    capfd: pytest.CaptureFixture[str], recwarn: pytest.WarningsRecorder
) -> None:
    build_scenes(WORLD, FLEET, 0.005)
    assert not recwarn.list
    assert capfd.readouterr() == ("", "")


def test_the_first_rover_is_the_model_of_a_single_one(pair: tuple[Simulation, Simulation]) -> None:
    """And what belongs to the second stands behind it, under names of its own."""
    alone = build_scene(WORLD, LEO, TIMESTEP_NS / 1e9).model
    model, (one, other) = pair[0].model, pair
    counts = alone.nq, alone.nv, alone.nu, alone.nbody
    assert [model.body(n).name for n in range(alone.nbody)] == [
        alone.body(n).name for n in range(alone.nbody)
    ]
    assert np.array_equal(model.dof_damping[: alone.nv], alone.dof_damping)
    assert (other.scene.qpos_at, other.scene.root) == (counts[0], counts[3])
    assert set(other.motors) == set(range(counts[2], model.nu))
    assert (one.scene.prefix, other.scene.prefix) == ("", "/b/")
    assert other.position[:2] == pytest.approx((0.8, 0.1), abs=0.05)
    assert math.remainder(other.yaw - 2.0, math.tau) == pytest.approx(0.0, abs=0.02)
    fallen = simulations((build_scene(WORLD, LEO, TIMESTEP_NS / 1e9),), TIMESTEP_NS)[0]
    assert one.pose == pytest.approx(fallen.pose, abs=1e-6)


def test_no_rover_of_a_fleet_meets_itself_and_each_meets_all_others_and_the_ground() -> None:
    members = (*FLEET, Member("c", LEO, (-2.0, -2.0, 0.0)))
    scenes = build_scenes(WORLD, members, TIMESTEP_NS / 1e9)
    model = scenes[0].model
    parts = [[g for g in scene.geoms() if model.geom_group[g] == 3] for scene in scenes]
    ground = model.geom("terrain").id

    def meet(one: int, other: int) -> bool:
        pairs = ((one, other), (other, one))
        return any(model.geom_contype[a] & model.geom_conaffinity[b] for a, b in pairs)

    for one, own in enumerate(parts):
        assert all(meet(geom, ground) for geom in own)
        for other, theirs in enumerate(parts):
            assert {meet(a, b) for a in own for b in theirs} == {one != other}


def test_who_drives_into_another_touches_a_hazard_and_so_does_the_other(
    pair: tuple[Simulation, Simulation],
) -> None:
    one, other = pair
    sets, most, counted = (own(one), own(other)), 0.0, 0
    assert sets[0].isdisjoint(sets[1])
    assert set(one.scene.others()) == {g for g in sets[1] if one.model.geom_group[g] == 3}
    one.command_wheels(np.full(4, 8.0))
    one.physics.steps_per_tick = 1  # so that the contacts of a tick are those of its only step
    for _ in range(600):
        one.physics.tick()
        forces = touches(one, *sets)
        counted += len(forces)
        for simulation in pair:
            strongest = simulation.contacts.strongest.get("hazard")
            assert (strongest is not None) == bool(forces)
            if strongest is not None:
                assert strongest.force == max(forces)
                assert strongest.pose == simulation.pose.tolist()
        most = max([most, *forces])
    assert counted > 10
    assert most > 5.0
    touch = other.contacts.strongest["hazard"]
    assert {touch.part} < sets[1]
    assert other.contacts.name_of(touch.other).startswith("a/")
    assert one.contacts.name_of(touch.part).startswith("b/")
    assert other.contacts.name_of(touch.part) == one.contacts.name_of(touch.part).removeprefix("b/")


def test_what_one_touches_is_not_told_of_the_other_that_touches_something_else_meanwhile(
    pair: tuple[Simulation, Simulation],
) -> None:
    one, other = pair
    one.pose[0], other.pose[:] = -0.3, (1.5, 1.5, 0.25, 0.0, 1.0, 0.0, 0.0)  # in the wall; on its roof
    for _ in range(20):
        one.tick()
        told = [set(simulation.contacts.strongest) for simulation in pair]
        if all(told):
            break
    assert told == [{"hazard"}, {"scrape"}]


def test_a_reset_is_of_one_alone(pair: tuple[Simulation, Simulation]) -> None:
    one, other = pair
    start = other.pose.copy()
    for simulation in pair:
        simulation.command_wheels(np.full(4, -2.0))
    for _ in range(20):
        one.tick()
    kept = [values.copy() for values in (one.pose, one.twist)]
    sums = one.summed("imu_gyro").copy()
    other.return_to_start()
    assert np.array_equal(other.pose, start)
    assert not other.summed("imu_gyro").any()
    other.put(1.0, -1.0, 0.5)
    assert other.position[:2] == pytest.approx((1.0, -1.0), abs=0.05)
    assert np.abs(other.twist).max() < 0.01
    assert [np.array_equal(*both) for both in zip(kept, (one.pose, one.twist), strict=True)] == [
        True
    ] * 2
    assert np.array_equal(one.summed("imu_gyro"), sums)
    assert one.time_ns == other.time_ns == 200_000_000
    x = one.position[0]
    one.tick()
    assert one.position[0] < x, "it drives on"
    one.summed("imu_gyro")[:], other.summed("imu_gyro")[:] = 1.0, 2.0
    there = other.pose.copy()
    one.return_to_start()
    assert (one.summed("imu_gyro") == 0.0).all()
    assert (other.summed("imu_gyro") == 2.0).all()
    assert np.array_equal(other.pose, there)


def test_friction_is_stiff_as_long_as_one_is_parked(pair: tuple[Simulation, Simulation]) -> None:
    one, other = pair
    stiff = [one.model.opt.impratio]
    for simulation, speed in ((one, 1.0), (other, 1.0), (one, 0.0)):
        simulation.command_wheels(np.full(4, speed))
        stiff.append(one.model.opt.impratio)
    assert stiff == [30.0, 30.0, 1.0, 30.0]


def test_who_leaves_the_map_or_diverges_is_named(pair: tuple[Simulation, Simulation]) -> None:
    one, other = pair
    other.pose[0] = 2.6
    with pytest.raises(RunFailed, match=r"^b reached the edge of the map at t = 0\.01 s \(x = 2\.6"):
        one.tick()
    other.pose[0], other.twist[0] = 0.8, 1e11
    with pytest.raises(Diverged, match=r"^b: the simulation diverged at t = 0\.02 s"):
        one.tick()
    one.twist[0] = math.nan
    with pytest.raises(Diverged, match=r"^a or b: the simulation diverged at t = 0\.03 s"):
        one.tick()
