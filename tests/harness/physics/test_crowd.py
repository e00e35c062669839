"""People in the physics: where they are, who is touched, and that nobody is pushed unless told."""

from collections.abc import Callable, Sequence

import mujoco
import numpy as np
import pytest

from harness.physics.contacts import Touch
from harness.physics.crowd import Crowd
from harness.physics.simulation import Simulation
from harness.robots.lidar import LidarSpec
from harness.samples import Place
from harness.sensors.lidar import Lidar
from harness.world.actors.social_force import SocialForceWalker

MakeSimulation = Callable[..., Simulation]
Body = tuple[float, float, float]
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
    np.testing.assert_allclose(simulation.data.mocap_pos, crowd(simulation).positions())
    crowd(simulation).restart(simulation.time_ns)
    x, y, _ = crowd(simulation).positions()[0]
    np.testing.assert_allclose(simulation.data.mocap_pos[:, :2].tolist()[0], [x, y])  # at once
    assert (x, y) == (1.0, 1.0)
    again = []
    for _ in range(50):
        simulation.tick()
        again.append(tuple(simulation.data.body("s_actor").xpos))
    np.testing.assert_allclose(again, social, atol=1e-3)  # the rover has crept a little
    assert simulation.data.body("g_actor").xpos[1] == pytest.approx(0.5)


def test_a_social_walker_keeps_from_the_rover_and_from_others_and_not_from_itself(
    make_simulation: MakeSimulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept, walk = list[list[tuple[float, float]]](), SocialForceWalker.walk

    def watched(one: SocialForceWalker, time_s: float, step_s: float, bodies: Sequence[Body]) -> Place:
        kept.append(sorted((x, y) for x, y, _ in bodies))
        return walk(one, time_s, step_s, bodies)

    monkeypatch.setattr(SocialForceWalker, "walk", watched)
    simulation = make_simulation(actors=("s=social:within=2.5", PASSES))
    _, other = crowd(simulation).places
    kept.clear()
    rover = simulation.position[:2]
    simulation.tick()
    assert kept == [sorted([rover, (other.x, other.y)])]


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


def driven_into(
    make_simulation: MakeSimulation, *actors: str
) -> tuple[Simulation, list[bytes], dict[int, Touch]]:
    """2 s straight ahead: the states after each tick, and the touches of hazards by tick."""
    simulation = make_simulation(actors=actors)
    simulation.command_wheels(np.full(4, 4.0))
    path, touches = [], {}
    for tick in range(200):
        simulation.tick()
        path.append(simulation.data.qpos.tobytes())
        if touch := simulation.contacts.strongest.get("hazard"):
            touches[tick] = touch
    return simulation, path, touches


def test_one_who_is_driven_into_is_touched_and_nobody_is_pushed(make_simulation: MakeSimulation) -> None:
    """The path is that of a run without people, to the bit; who is solid is touched at the same time."""
    _, alone, none = driven_into(make_simulation)
    simulation, path, touches = driven_into(make_simulation, "x=0.8,0")
    solid, stopped, pushed = driven_into(make_simulation, "x=0.8,0:push=1", "y=-1,1:push=1")
    assert (path, none) == (alone, {})
    model, first = simulation.model, touches[min(touches)]
    assert (model.geom(first.other).name, first.force) == ("x_actor", 0.0)
    assert first.position[:2] == pytest.approx((0.55, 0.0), abs=0.15)  # its front, wherever that meets
    assert model.geom(first.part).name.startswith(("wheel", "body_"))
    met = min(tick for tick, touch in pushed.items() if touch.force > 0.0)
    assert abs(min(touches) - met) <= 1
    assert sorted(touches) == list(range(min(touches), max(touches) + 1))
    assert stopped != alone
    assert max(touch.force for touch in pushed.values()) > 10.0
    assert {solid.contacts.name_of(touch.other) for touch in pushed.values()} == {"x_actor"}
    assert solid.position[0] < 0.4 < simulation.position[0]
