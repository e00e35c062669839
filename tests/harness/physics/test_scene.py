"""What MuJoCo gets of a world and a rover, read back from the compiled model."""

import math
import shutil
from dataclasses import replace
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
import pytest

from harness.physics import stage
from harness.physics.berths import Member
from harness.physics.scene import Dress, Scene, build_scene, build_scenes
from harness.robots import ROVERS, RoverSpec, find_rover
from harness.view.picture import QUALITY
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, convex, orientation, surface
from harness.world.world import World
from tests.support.rovers import LEO

OBSTACLES = (
    Obstacle(
        kind=ObstacleKind.HAZARD,
        shape="box",
        half_size=(0.1, 0.2, 0.3),
        position=(1.0, -1.5, 2.0),
        quaternion=orientation(0.7, 0.2),
    ),
    Obstacle(kind=ObstacleKind.ROCK, shape="ellipsoid", half_size=(0.3, 0.2, 0.1), position=(-1, 1, 0)),
    Obstacle(kind=ObstacleKind.HAZARD, shape="cylinder", half_size=(0.1, 0.4), position=(1, 1, 0.4)),
)
HEIGHTS = -2.0 + np.array(
    [[0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0.25], [0, 0.5, 0, 0, 0]], float
)

DRESS = partial(stage.dress, quality=QUALITY)


def scene_of(rover: RoverSpec = LEO, timestep: float = 0.002, dress: Dress | None = None) -> Scene:
    world = World("w", Heightfield(HEIGHTS, cell=2.0), OBSTACLES, 0, 0.5)
    return build_scenes(world, (Member("", rover, world.start),), timestep, dress)[0]


@pytest.fixture(scope="module")
def model() -> mujoco.MjModel:
    return scene_of().model


@pytest.fixture(scope="module")
def dressed() -> mujoco.MjModel:
    """The scene as it is looked at."""
    return scene_of(dress=DRESS).model


def test_the_ground_has_its_heights_where_the_world_has_them(model: mujoco.MjModel) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    only_terrain = np.array([1, 0, 0, 0, 0, 0], np.uint8)

    def top(x: float, y: float) -> float:
        start, down, hit = np.array([x, y, 50.0]), np.array([0.0, 0.0, -1.0]), np.zeros(1, np.int32)
        return 50.0 - float(mujoco.mj_ray(model, data, start, down, only_terrain, 1, -1, hit))

    # Row 4, column 1 is y = 4, x = -2; the ray falls a hair inside the edge.
    assert top(-2.0, 4.0 - 1e-9) == pytest.approx(-1.5, abs=1e-6)
    assert top(4.0 - 1e-9, 2.0) == pytest.approx(-1.75, abs=1e-6)
    assert top(0.0, 0.0) == pytest.approx(-2.0, abs=1e-6)
    assert model.hfield_size[0] == pytest.approx((4.0, 4.0, 0.5, 1.0))  # a metre of solid ground


def test_obstacles_are_geoms_of_two_bodies_with_size_place_and_turn(model: mujoco.MjModel) -> None:
    names = ("hazard_0", "rock_1", "hazard_2")
    types = (mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtGeom.mjGEOM_ELLIPSOID, mujoco.mjtGeom.mjGEOM_CYLINDER)
    for name, kind, obstacle in zip(names, types, OBSTACLES, strict=True):
        geom = model.geom(name)
        assert geom.type[0] == kind
        assert geom.size[: len(obstacle.half_size)] == pytest.approx(obstacle.half_size)
        assert geom.pos == pytest.approx(obstacle.position)
        assert geom.quat == pytest.approx(obstacle.quaternion)
        body = {"hazard": "hazards", "rock": "rocks"}[name.split("_")[0]]
        assert model.body(geom.bodyid[0]).name == body
        assert (geom.group[0], geom.contype[0], geom.conaffinity[0]) == (1, 2, 1)
    data = mujoco.MjData(model)
    data.qpos[2] = 20.0  # the rover in the air; rock and pole stand in the ground
    mujoco.mj_forward(model, data)
    assert data.ncon == 0


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
def test_what_is_only_looked_at_is_left_out_unless_pictures_are_taken(rover: RoverSpec) -> None:
    models = [scene_of(rover, dress=dress).model for dress in (None, DRESS)]
    assert [set(model.geom_group.tolist()) for model in models] == [{0, 1, 3}, {0, 1, 2, 3}]
    colours = [models[1].geom(name).rgba.tolist() for name in ("hazard_0", "rock_1", "hazard_2")]
    assert colours[0] == colours[2] != colours[1]


@pytest.mark.parametrize(("timestep", "factor"), [(0.001, 1.0), (0.02, None)])
def test_constraints_are_as_stiff_as_in_the_model_file_as_far_as_the_time_step_allows(
    timestep: float, factor: float | None
) -> None:
    file = mujoco.MjModel.from_xml_path(str(LEO.model_path))
    model = scene_of(timestep=timestep).model

    assert model.opt.timestep == timestep
    assert file.neq > 0
    expected = file.eq_solref[:, 0] if factor else np.full(file.neq, 2 * timestep)
    assert model.eq_solref[:, 0] == pytest.approx(expected)
    assert model.eq_solref[:, 1] == pytest.approx(file.eq_solref[:, 1])


def test_the_sun_shines_down_over_the_shoulder_and_casts_shadows(dressed: mujoco.MjModel) -> None:
    assert dressed.nlight == 1
    assert dressed.light_type[0] == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
    assert dressed.light_castshadow[0]
    at = np.array([3.0, -2.0, 1.0])
    for azimuth in (0.0, 130.0):
        stage.aim_sun(dressed, at, azimuth)
        direction, back = dressed.light_dir[0], at - dressed.light_pos[0]
        looks = np.array([math.cos(math.radians(azimuth)), math.sin(math.radians(azimuth)), 0.0])
        assert np.linalg.norm(direction) == pytest.approx(1.0)
        assert direction[2] < -0.4
        assert looks @ direction > 0.5  # onto what the camera looks at, from behind it
        assert back / np.linalg.norm(back) == pytest.approx(direction)


def test_a_model_file_that_has_changed_is_read_anew(tmp_path: Path) -> None:
    shutil.copytree(LEO.folder, tmp_path / LEO.name)
    copied = LEO.but(folder=tmp_path / LEO.name)
    before = scene_of(copied).model.opt.gravity[2]
    text = copied.model_path.read_text()
    copied.model_path.write_text(text.replace(f"0 0 {before:g}", "0 0 -1.5"))
    assert [before, scene_of(copied).model.opt.gravity[2]] == [-LEO.gravity, -1.5]


@pytest.mark.parametrize("asked", [(1, 3), (300, 90)])
def test_a_model_made_for_training_is_solved_as_far_as_others_or_as_it_asks(
    asked: tuple[int, int], tmp_path: Path
) -> None:
    shutil.copytree(LEO.folder, tmp_path / LEO.name)
    copied = LEO.but(folder=tmp_path / LEO.name)
    text = copied.model_path.read_text()
    options = '<option iterations="{}" ls_iterations="{}" '.format(*asked)
    copied.model_path.write_text(text.replace("<option ", options))
    solver, others = (
        (m.opt.iterations, m.opt.ls_iterations) for m in (scene_of(copied).model, scene_of().model)
    )
    assert solver == tuple(map(max, asked, others))


def test_a_world_from_a_file_brings_its_place_gravity_friction_and_meshes() -> None:
    corners = np.array([(x, y, z) for x in (9.0, 10.0) for y in (0.0, 1.0) for z in (0.0, 0.5)])
    roof = np.array([(9.0, 2.0, 3.0), (11.0, 2.0, 3.0), (9.0, 4.0, 3.0), (11.0, 4.0, 4.0)])
    red = (1.0, 0.0, 0.0, 1.0)
    obstacles = (
        replace(convex(ObstacleKind.HAZARD, corners), color=red),
        surface(roof, np.array([[0, 1, 2], [1, 3, 2]])),
    )
    ground = Heightfield(np.full((5, 5), -1.0), 2.0, (10.0, 2.0))
    world = World("w", ground, obstacles, 0, None, gravity=1.62, friction=0.25)
    model = build_scene(world, LEO, 0.002).model
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    groups, hit = np.array([1, 1, 0, 0, 0, 0], np.uint8), np.zeros(1, np.int32)
    for x, y, z in ((9.5, 0.5, 0.5), (9.5, 2.5, 3.0), (13.5, 5.5, -1.0), (6.5, -1.5, -1.0)):
        fallen = mujoco.mj_ray(
            model, data, np.array([x, y, 9.0]), np.array([0.0, 0, -1]), groups, 1, -1, hit
        )
        assert 9.0 - fallen == pytest.approx(z, abs=1e-5), (x, y)
    assert model.opt.gravity.tolist() == [0.0, 0.0, -1.62]
    hazard, deck = model.geom("hazard_0"), model.geom("deck_1")
    assert (hazard.contype[0], deck.contype[0], deck.conaffinity[0]) == (2, 0, 0)
    assert model.body(int(hazard.bodyid[0])).name == "hazards"
    assert hazard.rgba.tolist() == list(red)


@pytest.mark.parametrize("priority", [0, 1])
def test_the_lesser_of_the_worlds_friction_and_the_rovers_counts(priority: int, tmp_path: Path) -> None:
    """Of wheels with 1 and a body with 0.3, as MuJoCo has it in their contacts."""
    shutil.copytree(LEO.folder, tmp_path / LEO.name)
    copied = LEO.but(folder=tmp_path / LEO.name)
    text = copied.model_path.read_text().replace('priority="1"', f'priority="{priority}"')
    copied.model_path.write_text(text)
    world = World("w", Heightfield(np.zeros((5, 5)), 2.0), (), 0, None, friction=0.5)
    model = build_scene(world, copied, 0.002).model
    data = mujoco.MjData(model)
    data.qpos[2] = -0.1  # deep in the ground
    mujoco.mj_forward(model, data)
    kinds = {model.geom(contact.geom[1]).name[:5]: contact.friction[0] for contact in data.contact}
    assert kinds == {"body_": 0.3, "wheel": 0.5}


def test_rovers_whose_meshes_are_called_alike_have_each_its_own(tmp_path: Path) -> None:
    rovers = []
    for name, size in (("one", 0.1), ("other", 0.2)):
        folder = shutil.copytree(LEO.folder, tmp_path / name)
        model = folder / "leo.xml"
        text = model.read_text().replace("<asset>", '<asset><mesh name="hull" file="hull.obj"/>', 1)
        geom = '<body name="rover"><geom type="mesh" mesh="hull" pos="0 0 0.4" mass="0.1"/>'
        model.write_text(text.replace('<body name="rover">', geom, 1))
        corners = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
        lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f 1 3 2", "f 1 2 4", "f 1 4 3", "f 2 3 4"]
        (folder / "hull.obj").write_text("\n".join(lines))
        rovers.append(find_rover(str(folder)))
    fleet = [Member(of.folder.name, of, (3.0 * i, 0.0, 0.0)) for i, of in enumerate(rovers)]
    world = World("w", Heightfield(np.zeros((41, 41)), cell=0.5), (), 0, 0.5)
    model = build_scenes(world, fleet, 0.002)[0].model
    extents = [np.ptp(vertices) for vertices in np.split(model.mesh_vert, model.mesh_vertadr[1:])]
    assert extents[1] == pytest.approx(2.0 * extents[0])
