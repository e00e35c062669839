import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from harness.base.errors import RunFailed, UsageError
from harness.physics.scene import Scene, build_scene
from harness.physics.simulation import Simulation
from harness.physics.start import DROP_HEIGHT, check_room, check_start, spawn_pose
from harness.world.heightfield import Field, Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.world import Start, World, starting_at
from tests.support.rovers import ROVER_ZERO4WD

CELL, FINE, TIMESTEP_NS = 0.2, 0.02, 5_000_000
X, Y = np.meshgrid(np.arange(-40, 41) * CELL, np.arange(-20, 21) * CELL)  # 16 x 8 m
BOULDER = Obstacle(
    kind=ObstacleKind.HAZARD, shape="ellipsoid", half_size=(0.5,) * 3, position=(5.0, -2.0, 0.3)
)
ROCK = Obstacle(
    kind=ObstacleKind.ROCK, shape="box", half_size=(0.1, 0.1, 0.1), position=(-5.0, 2.0, 0.1)
)


def scene_of(heights: Field, start: Start) -> Scene:
    world = World("bench", Heightfield(heights, CELL), (ROCK, BOULDER), 0, None, start=start)
    return build_scene(world, ROVER_ZERO4WD, TIMESTEP_NS / 1e9)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_a_rover_is_set_down_over_the_highest_ground_below_its_turned_footprint(yaw: float) -> None:
    x, y = np.meshgrid(np.arange(-400, 401) * FINE, np.arange(-200, 201) * FINE)
    scene = scene_of(0 * X, (3.0, -1.5, yaw))
    world = replace(scene.world, ground=Heightfield(0.1 * x + 0.2 * y, FINE))
    pose = spawn_pose(replace(scene, world=world), world.start)
    x_min, x_max, y_min, y_max = ROVER_ZERO4WD.footprint
    corners = [
        0.1 * (3.0 + math.cos(yaw) * x - math.sin(yaw) * y)
        + 0.2 * (-1.5 + math.sin(yaw) * x + math.cos(yaw) * y)
        for x in (x_min, x_max)
        for y in (y_min, y_max)
    ]
    assert pose[:2].tolist() == [3.0, -1.5]
    expected = max(corners) + ROVER_ZERO4WD.rest_height + DROP_HEIGHT
    assert pose[2] == pytest.approx(expected, abs=0.3 * FINE / 2)  # sampled each half cell
    assert pose[3:] == pytest.approx((math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)))


@pytest.mark.parametrize(
    ("start", "name"),
    [
        ((5.0, -2.0, 0.0), "hazard_1"),
        ((4.3, -2.0, 1.0), "hazard_1"),
        ((-5.0, 2.3, math.pi / 2), "rock_0"),
        ((4.0, -2.0, 0.0), None),
        ((-5.0, 2.6, math.pi), None),
    ],
)
def test_a_start_inside_an_obstacle_is_refused_by_its_name(start: Start, name: str | None) -> None:
    scene = scene_of(np.zeros_like(X), start)
    if name is None:
        check_room(scene)
        return
    with pytest.raises(UsageError, match=rf"start .* is inside {name}; choose another --start"):
        check_room(scene)


@pytest.mark.parametrize(
    ("moved", "roll", "told"),
    [
        (0.49, 59.0, None),
        (0.51, 0.0, "it slid 0.5 m and leans by 0 deg"),
        (0.0, 61.0, "leans by 61 deg"),
    ],
)
def test_a_start_where_it_slides_or_tips_over_is_refused(
    moved: float, roll: float, told: str | None, make_simulation: Callable[..., Simulation]
) -> None:
    simulation = make_simulation()
    half = math.radians(roll) / 2
    simulation.data.qpos[:7] = (moved, 0.0, 0.2, math.cos(half), math.sin(half), 0.0, 0.0)
    if told is None:
        check_start(simulation.scene, simulation.data)
        return
    with pytest.raises(UsageError, match=f"no rover can stand at start 0,0,0: .*{told}"):
        check_start(simulation.scene, simulation.data)


def drive_on(simulation: Simulation) -> None:
    for _ in range(100):
        simulation.tick()


@pytest.mark.parametrize(("x", "y"), [(7.49, 0.0), (-7.49, 0.0), (0.0, 3.49), (7.49, -3.49)])
def test_a_start_just_within_the_edge_of_the_map_is_one_and_at_it_is_none(x: float, y: float) -> None:
    """The edge is half a metre wide; a rover that faces it stands on the ground, and goes no further."""
    ground, yaw = Heightfield(np.full_like(X, 0.7), CELL), math.atan2(y, x)
    world = starting_at(World("bench", ground, (), 0, None), (x, y, yaw))
    simulation = Simulation(build_scene(world, ROVER_ZERO4WD, TIMESTEP_NS / 1e9), TIMESTEP_NS)
    assert simulation.position == pytest.approx((x, y, 0.7 + ROVER_ZERO4WD.rest_height), abs=5e-3)
    simulation.tick()
    simulation.command_wheels(np.full(4, 5.0))
    with pytest.raises(RunFailed, match="the rover reached the edge of the map at t = "):
        drive_on(simulation)
    beyond = (x + math.copysign(0.01, x) * bool(x), y + math.copysign(0.01, y) * bool(y), yaw)
    with pytest.raises(UsageError, match=r"at its edge; give x between -7\.5 and 7\.5 m, y betw"):
        starting_at(world, beyond)
