"""People in the physics: where they are, who is touched, and that nobody is pushed unless told."""

from collections.abc import Callable
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from harness.physics.crowd import Crowd
from harness.physics.simulation import Simulation
from harness.sensors.lidar import Lidar
from harness.sensors.lidar_spec import LidarSpec

MakeSimulation = Callable[..., Simulation]
PASSES = "g=1,1/1,-1"
STANDS = ("x=1.2,0", "y=-1.2,0.3:height=1,radius=0.3", "z=0,-1.3:radius=0.1")


def crowd(simulation: Simulation) -> Crowd:
    assert simulation.crowd is not None
    return simulation.crowd


def test_after_a_tick_people_are_where_their_time_has_them(make_simulation: MakeSimulation) -> None:
    heights = np.tile(np.linspace(0.0, 0.4, 41), (41, 1))
    simulation = make_simulation(heights=heights, actors=(PASSES, "s=social:within=2.5"))
    social = []
    for _ in range(50):
        simulation.tick()
        social.append(tuple(simulation.data.body("s_actor").xpos))
    np.testing.assert_allclose(simulation.data.body("g_actor").xpos, [1.0, 0.5, 0.3 + 0.875])
    np.testing.assert_allclose(
        simulation.data.body("g_actor").xmat.reshape(3, 3)[:, 0], [0, -1, 0], atol=1e-9
    )
    assert crowd(simulation).positions()[0] == pytest.approx((1.0, 0.5, 1.175))
    assert len(set(social)) > 45
    crowd(simulation).restart(simulation.time_ns)
    again = []
    for _ in range(50):
        simulation.tick()
        again.append(tuple(simulation.data.body("s_actor").xpos))
    np.testing.assert_allclose(again, social, atol=1e-3)  # the rover has crept a little
    assert simulation.data.body("g_actor").xpos[1] == pytest.approx(0.5)


def test_the_lidar_sees_them_as_mujoco_does(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation("leo", actors=(*STANDS, PASSES))
    model, data = simulation.model, simulation.data
    spec = LidarSpec(beams=360)
    lidar, site = Lidar(model, spec), model.site("lidar").id
    hits = 0
    for _ in range(30):
        simulation.tick()
        mujoco.mj_kinematics(model, data)
        ours = lidar.scan(data)
        level = np.column_stack([np.cos(spec.angles), np.sin(spec.angles), np.zeros(360)])
        beams = level @ data.site_xmat[site].reshape(3, 3).T
        geoms, theirs = np.zeros(360, np.int32), np.zeros(360)
        groups, origin = np.array([1, 1, 0, 0, 0, 0], np.uint8), data.site_xpos[site]
        mujoco.mj_multiRay(
            model, data, origin, beams.ravel(), groups, 1, -1, geoms, theirs, None, 360, 10.0
        )
        theirs[(theirs < 0.0) | (theirs > spec.range_max)] = np.inf
        np.testing.assert_allclose(ours, theirs, atol=1e-5)
        hits += int(np.isfinite(theirs).sum())
    assert hits > 30 * 60


def test_one_who_is_driven_into_is_touched_and_nobody_is_pushed(make_simulation: MakeSimulation) -> None:
    """The path is that of a run without people, to the bit."""
    paths, touched = [], []
    for actors in ((), ("x=0.8,0",)):
        simulation = make_simulation(actors=actors)
        simulation.command_wheels(np.full(4, 4.0))
        path, touches = [], []
        for _ in range(200):
            simulation.tick()
            path.append(simulation.data.qpos.tobytes())
            touches += [(simulation.time_ns, simulation.contacts.strongest.get("hazard"))]
        paths.append(path)
        touched.append({time: touch for time, touch in touches if touch is not None})
    assert paths[0] == paths[1]
    assert not touched[0]
    model, times = simulation.model, sorted(touched[1])
    first = touched[1][times[0]]
    assert (model.geom(first.other).name, first.force) == ("x_actor", 0.0)
    assert model.geom(first.part).name.startswith(("wheel", "body_"))
    reach = max(simulation.scene.rover.footprint)
    assert first.pose[0] == pytest.approx(0.8 - 0.25 - reach, abs=0.06)
    assert all(after - before == 10_000_000 for before, after in pairwise(times))


def test_one_who_pushes_stops_the_rover_with_a_force(make_simulation: MakeSimulation) -> None:
    simulation = make_simulation(actors=("x=0.8,0:push=1", "y=-1,1:push=1"))
    simulation.command_wheels(np.full(4, 4.0))
    strongest = 0.0
    for _ in range(200):
        simulation.tick()
        if touch := simulation.contacts.strongest.get("hazard"):
            assert simulation.contacts.name_of(touch.other) == "x_actor"
            strongest = max(strongest, touch.force)
    assert strongest > 10.0
    assert simulation.position[0] < 0.4
