"""What is touched in states written by hand, against every contact that MuJoCo has then."""

from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from harness.physics.contacts import ContactWatch, RoverContacts
from harness.physics.simulation import Simulation
from harness.world.obstacles import Obstacle, ObstacleKind, convex

WALL = Obstacle(
    kind=ObstacleKind.HAZARD, shape="box", half_size=(0.05, 0.6, 0.3), position=(0.75, 0.1, 0.3)
)
STONE = Obstacle(
    kind=ObstacleKind.ROCK, shape="ellipsoid", half_size=(0.06, 0.09, 0.04), position=(0.0, 0.6, 0.1)
)
LEVEL = (1.0, 0.0, 0.0, 0.0)
AGAINST_THE_WALL = (0.46, 0.0, 0.0, *LEVEL)
ON_THE_STONE = (0.0, 0.6, 0.05, *LEVEL)
ON_ITS_ROOF = (-0.8, -0.3, 0.2, 0.0, 1.0, 0.0, 0.0)
IN_THE_AIR = (-0.8, -0.3, 1.0, *LEVEL)


@pytest.fixture(scope="module")
def simulation(make_simulation: Callable[..., Simulation]) -> Simulation:
    return make_simulation(obstacles=(WALL, STONE))


def put(simulation: Simulation, pose: tuple[float, ...]) -> None:
    simulation.data.qpos[:7], simulation.data.qvel[:] = pose, 0.0
    mujoco.mj_forward(simulation.model, simulation.data)


def touches_by_hand(simulation: Simulation) -> dict[str, list[tuple[float, str, str]]]:
    """Force [N], part and obstacle of every contact but those of wheels with the ground, by kind."""
    model, data = simulation.model, simulation.data
    kinds = {"hazards": "hazard", "rocks": "rock", "world": "scrape"}
    found: dict[str, list[tuple[float, str, str]]] = {}
    for index, contact in enumerate(data.contact):
        geoms = [model.geom(geom) for geom in contact.geom]
        bodies = [model.body(int(geom.bodyid[0])).name for geom in geoms]
        (fixed,) = (place for place, name in enumerate(bodies) if name in kinds)
        part = geoms[1 - fixed].name
        kind = kinds[bodies[fixed]]
        if kind != "scrape" or part.startswith("body_"):
            wrench = np.zeros(6)
            mujoco.mj_contactForce(model, data, index, wrench)
            other = "ground" if kind == "scrape" else geoms[fixed].name
            found.setdefault(kind, []).append((wrench[0], part.removeprefix("body_"), other))
    return found


def looked(simulation: Simulation) -> RoverContacts:
    watch = ContactWatch((simulation.scene,), simulation.data)
    watch.look()
    (rover,) = watch.rovers
    rover.show(0)
    return rover


def told(watch: RoverContacts) -> dict[str, tuple[float, str, str]]:
    names = watch.name_of
    return {k: (t.force, names(t.part), names(t.other)) for k, t in watch.strongest.items()}


@pytest.mark.parametrize(
    ("pose", "kinds"),
    [
        (AGAINST_THE_WALL, {"hazard"}),
        (ON_THE_STONE, {"rock"}),
        (ON_ITS_ROOF, {"scrape"}),
        (IN_THE_AIR, set()),
    ],
)
def test_the_strongest_contact_of_each_kind_is_told(
    pose: tuple[float, ...], kinds: set[str], simulation: Simulation
) -> None:
    put(simulation, pose)
    watch = looked(simulation)
    expected = {kind: max(touches) for kind, touches in touches_by_hand(simulation).items()}
    assert set(expected) == kinds
    assert told(watch) == expected
    counted = {"hazard": 0, "rock": 0, "scrape": 0}
    for index in range(simulation.model.nsensor):
        sensor = simulation.data.sensor(index)
        kind = sensor.name.partition("_")[0]
        if "contact" in sensor.name:
            counted[kind] += int(sensor.data[0])
    assert {kind for kind, count in counted.items() if count} == kinds


def test_of_several_steps_the_strongest_is_kept_until_a_tick_begins(simulation: Simulation) -> None:
    watch = ContactWatch((simulation.scene,), simulation.data)
    (rover,), (x, *rest), forces = watch.rovers, AGAINST_THE_WALL, []
    for deeper in (0.0, 0.01, 0.005):
        put(simulation, (x + deeper, *rest))
        forces.append(max(force for force, *_ in touches_by_hand(simulation)["hazard"]))
        watch.look(2)
    assert forces[0] < forces[2] < forces[1]
    assert rover.strongest == {}
    rover.show(2)
    touch = rover.strongest["hazard"]
    assert touch.force == forces[1]
    assert touch.pose == [x + 0.01, *rest]
    rover.note("hazard", touch._replace(part=touch.part + 1))
    assert rover.strongest["hazard"] == touch, "of equally strong ones the first"
    watch.begin()
    rover.show(2)
    assert rover.strongest == {}


def test_a_deck_is_ground_for_wheels_and_for_the_body(
    make_simulation: Callable[..., Simulation],
) -> None:
    corners = np.array([(x, y, z) for x in (-1.5, 1.5) for y in (-1.0, 1.0) for z in (1.0, 1.1)])
    simulation = make_simulation(obstacles=(convex(ObstacleKind.DECK, corners),))
    put(simulation, (0.0, 0.0, 1.099, *LEVEL))
    assert simulation.data.ncon > 0
    assert not looked(simulation).strongest
    put(simulation, (*ON_ITS_ROOF[:2], ON_ITS_ROOF[2] + 1.1, *ON_ITS_ROOF[3:]))
    assert {kind: name for kind, (_, _, name) in told(looked(simulation)).items()} == {
        "scrape": "ground"
    }
