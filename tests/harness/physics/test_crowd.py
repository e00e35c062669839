"""People in the physics: where they are, who is touched, and that nobody is pushed unless told."""

from collections.abc import Callable
from dataclasses import replace
from unittest.mock import Mock

import mujoco
import numpy as np
import pytest
from harness.world.actors.walker import SocialWalker

from harness.base.sim_time import TICK_NS
from harness.physics.contacts import Touch
from harness.physics.crowd import Crowd
from harness.physics.scene import Scene
from harness.physics.simulation import Simulation
from harness.robots import ROVERS
from harness.samples import Place
from harness.sensors.lidar import Lidar
from harness.sensors.lidar_spec import LidarSpec
from harness.world.heightfield import Heightfield
from harness.world.world import World, with_actors
from tests.support.words import parse_actors

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


def two_boxes(*actors: str) -> tuple[Crowd, mujoco.MjData]:
    """A crowd around two rovers at x = 0 and 3 m: boxes of 60 cm x 40 cm in spheres to look at."""
    bare = World("bare", Heightfield(np.zeros((81, 81)), 0.1), (), seed=0, difficulty=0.0)
    world = with_actors(bare, parse_actors(actors))
    spec = mujoco.MjSpec()
    box, sphere, capsule = (getattr(mujoco.mjtGeom, f"mjGEOM_{n}") for n in ("BOX", "SPHERE", "CAPSULE"))
    for name, x in (("one", 0.0), ("two", 3.0)):
        body = spec.worldbody.add_body(name=name, pos=(x, 0.0, 0.5))
        body.add_freejoint()
        body.add_geom(type=sphere, size=(0.9, 0.0, 0.0), contype=0, conaffinity=0)
        body.add_geom(type=box, size=(0.1, 0.1, 0.1))  # another solid part, which nobody meets
        body.add_geom(name=name, type=box, size=(0.3, 0.2, 0.1))
    spec.worldbody.add_body(name="flag", mocap=True)  # another that is moved by hand
    for actor in world.people:
        body = spec.worldbody.add_body(name=actor.name, mocap=True)
        body.add_geom(name=actor.name, type=capsule, size=(0.25, 0.625, 0.0), contype=0, conaffinity=0)
    model = spec.compile()
    data = mujoco.MjData(model)
    rovers = [replace(ROVERS["leo"], footprint=(-reach, 0.0, 0.0, 0.0)) for reach in (0.4, 0.5)]
    scenes = [
        Scene(model, world, rover, root=model.body(name).id)
        for name, rover in zip(("one", "two"), rovers, strict=True)
    ]
    return Crowd(scenes, data), data


def test_a_social_walker_is_told_of_all_rovers_and_of_all_others(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[tuple[float, float, list[tuple[float, float, float]]]] = []

    def walk(
        _: object, time_s: float, seconds: float, bodies: list[tuple[float, float, float]]
    ) -> Place:
        told.append((time_s, seconds, bodies))
        return Place(0.1 * len(told), -1.5, 0.0)

    monkeypatch.setattr(SocialWalker, "walk", walk)
    people, data = two_boxes(
        "x=1.5,-0.7:radius=0.3", "s=social:within=3.5", "y=1,3:radius=0.2", "t=social:within=3.5"
    )
    data.qpos[:2], data.qpos[7:9] = (0.1, 0.2), (2.9, -0.3)
    del told[:]
    monkeypatch.setattr(SocialWalker, "restart", restart := Mock())
    people.restart(5 * TICK_NS)
    assert restart.call_count == 2  # both of them begin anew
    people.move(6 * TICK_NS)
    people.move(8 * TICK_NS)
    np.testing.assert_allclose(
        [one[:2] for one in told[::2]], [(0.0, 0.0), (0.01, 0.01), (0.03, 0.01)], atol=1e-12
    )
    rovers, (x, y) = [(0.1, 0.2, 0.4), (2.9, -0.3, 0.5)], [(1.5, -0.7, 0.3), (1.0, 3.0, 0.2)]
    begins = [(*actor.begin, 0.25) for actor in people.actors]
    for number in range(3):  # the others where they were before anybody moved
        s, t = begins[1::2] if number == 0 else [(0.1 * (2 * number + n), -1.5, 0.25) for n in (-1, 0)]
        np.testing.assert_allclose(told[2 * number][2], [*rovers, x, y, t])
        np.testing.assert_allclose(told[2 * number + 1][2], [*rovers, x, s, y])


@pytest.mark.parametrize(("gap", "touches"), [(-0.001, True), (0.001, False)])
def test_a_touch_is_that_of_the_rover_whose_colliding_part_meets_a_person(
    gap: float, touches: bool
) -> None:
    people, data = two_boxes("far=-3,3", f"x=3,{0.2 + 0.25 + gap}")
    mujoco.mj_forward(people._model, data)
    watches = [Mock(), Mock()]
    people.look(watches)
    watches[0].note.assert_not_called()
    assert watches[1].note.call_count == touches
    if touches:
        kind, touch = watches[1].note.call_args.args
        names = [people._model.geom(geom).name for geom in (touch.part, touch.other)]
        assert (kind, touch.force, names) == ("hazard", 0.0, ["two", "x_actor"])
        assert touch.position[1] == pytest.approx(0.2 + gap / 2, abs=1e-6)
        assert touch.pose == pytest.approx([3.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0])


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
