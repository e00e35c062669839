"""The lidar against mj_multiRay over the whole scene, and what its ranges say (REP-117)."""

import math
from itertools import cycle, islice

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.robots.lidar import LidarSpec, scan_points
from harness.samples import LaserScan, PlacedScan, Pose
from harness.sensors.lidar import Lidar
from tests.harness.sensors.mujoco_rays import meets
from tests.support.rovers import LEO

Array = NDArray[np.float64]
Scene = tuple[mujoco.MjModel, mujoco.MjData]

TOLERANCE = 1e-5  # [m]
BOX, CYLINDER, CAPSULE, ELLIPSOID, MESH = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_MESH,
)
YAWED_BY_PI = (0.0, 0.0, 0.0, 1.0)  # as both rovers carry it


def terrain_spec(heights: Array, cell: float) -> mujoco.MjSpec:
    n = len(heights)
    half, relief = cell * (n - 1) / 2, max(float(np.ptp(heights)), 1e-3)
    spec, scaled = mujoco.MjSpec(), ((heights - heights.min()) / relief).ravel().tolist()
    spec.add_hfield(name="terrain", size=[half, half, relief, 1.0], nrow=n, ncol=n, userdata=scaled)
    kind, place = mujoco.mjtGeom.mjGEOM_HFIELD, [0.0, 0.0, heights.min()]
    spec.worldbody.add_geom(name="terrain", type=kind, hfieldname="terrain", pos=place, group=0)
    return spec


def add_rover(spec: mujoco.MjSpec, lidar_height: float) -> None:
    """A free body whose shell, in the rover's two groups, encloses its own lidar."""
    rover = spec.worldbody.add_body(name="rover", pos=[0.0, 0.0, 0.0])
    rover.add_freejoint()
    for group in (2, 3):
        rover.add_geom(type=BOX, size=[0.3, 0.3, 0.5 + lidar_height], group=group)
    rover.add_site(name="imu", pos=[0.2, 0.1, 0.0])
    rover.add_site(name="lidar", pos=[0.0, 0.0, lidar_height], quat=YAWED_BY_PI)


def add_random_obstacles(spec: mujoco.MjSpec, rng: np.random.Generator, half: float) -> None:
    obstacles = spec.worldbody.add_body(name="obstacles")
    for shape in islice(cycle((BOX, CYLINDER, ELLIPSOID, CAPSULE)), 15):
        size, place = rng.uniform(0.05, 0.5, 3), [*rng.uniform(-half, half, 2), rng.uniform(-0.2, 0.6)]
        obstacles.add_geom(type=shape, size=size, pos=place, quat=rng.normal(size=4), group=1)
    for name in ("a", "b", "c"):
        spec.add_mesh(name=name, uservert=rng.uniform(-0.5, 0.5, 18).tolist())
        place = [*rng.uniform(-half, half, 2), rng.uniform(-0.2, 0.6)]
        obstacles.add_geom(type=MESH, meshname=name, pos=place, quat=rng.normal(size=4), group=1)


def compiled(spec: mujoco.MjSpec) -> Scene:
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def place_rover(scene: Scene, position: Array, tilt: float, rng: np.random.Generator) -> None:
    model, data = scene
    quaternion = np.array([1.0, *(tilt * rng.normal(size=2)), rng.normal()])
    data.qpos[:7] = [*position, *(quaternion / np.linalg.norm(quaternion))]
    mujoco.mj_kinematics(model, data)


def flat_scene(*walls: tuple[float, float, float]) -> Scene:
    """Flat ground with a rover at its middle and walls at x, of half thickness and half height."""
    world = terrain_spec(np.zeros((5, 5)), 10.0)
    add_rover(world, 0.5)
    for x, thickness, height in walls:
        world.worldbody.add_geom(type=BOX, size=[thickness, 3.0, height], pos=[x, 0.0, 0.0], group=1)
    return compiled(world)


@pytest.mark.parametrize(
    ("limits", "walls", "ahead"),
    [
        ((0.15, 10.0), [], np.inf),
        ((0.15, 10.0), [(0.2, 0.1, 1.0)], -np.inf),  # its face 0.1 m ahead
        ((0.15, 10.0), [(0.251, 0.1, 1.0)], 0.151),
        ((0.15, 10.0), [(10.099, 0.1, 1.0)], 9.999),
        ((0.15, 10.0), [(10.101, 0.1, 1.0)], np.inf),
        ((1.5, 4.0), [(2.0, 0.5, 1.0)], 1.5),  # exactly a limit
        ((0.5, 1.5), [(2.0, 0.5, 1.0)], 1.5),
        ((0.15, 10.0), [(4.0, 0.5, 1.0), (2.0, 0.5, 1.0), (3.0, 0.5, 0.4)], 1.5),
    ],
)
def test_the_first_beam_and_the_last_read_the_nearest_wall_ahead_as_rep_117_says(
    limits: tuple[float, float], walls: list[tuple[float, float, float]], ahead: float
) -> None:
    """A site yawed by pi: azimuth -pi is robot-forward; a quarter on is left, where nothing is."""
    model, data = flat_scene(*walls)
    spec = LidarSpec(beams=361, range_min=limits[0], range_max=limits[1], angle_max=np.pi)
    ranges = Lidar(model, spec).scan(data)
    assert ranges[[0, -1]] == pytest.approx([ahead] * 2, abs=1e-6)
    assert (ranges[[90, 180, 270]] == np.inf).all()
    assert ranges.dtype == np.float32
    if ahead in limits:
        assert ranges[0] == ahead


def test_obstacle_of_unknown_shape_is_named() -> None:
    world = terrain_spec(np.zeros((3, 3)), 1.0)
    add_rover(world, 0.5)
    world.worldbody.add_geom(name="wall", type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.1] * 3, group=1)
    with pytest.raises(ValueError, match=r"'wall'.*available: box, cylinder, capsule, ellipsoid"):
        Lidar(world.compile(), LidarSpec())


def test_spheres_and_meshes_of_other_rovers_are_met_where_they_are() -> None:
    rng = np.random.default_rng(4)
    spec = terrain_spec(np.zeros((41, 41)), 0.25)
    add_rover(spec, 0.5)
    other = spec.worldbody.add_body(name="other", pos=[2.0, 1.0, 0.5])
    other.add_freejoint()
    spec.add_mesh(name="shell", uservert=rng.uniform(-0.5, 0.5, 24).tolist())
    other.add_geom(type=MESH, meshname="shell", group=3)
    other.add_geom(type=MESH, meshname="shell", pos=[0.0, -0.9, 0.0], quat=[1, 1, 0, 0], group=3)
    other.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.3, 0, 0], pos=[0.0, 0.9, 0.0], group=3)
    model, data = compiled(spec)
    others = [g for g in range(model.ngeom) if model.body(model.geom_bodyid[g]).name == "other"]
    lidar = Lidar(model, LidarSpec(beams=720), "lidar", others)
    data.qpos[7:] = (-1.8, 0.6, 0.5, np.cos(0.9), 0.0, 0.0, np.sin(0.9))  # it has driven on since
    mujoco.mj_kinematics(model, data)
    place, axes, angles = (
        data.site("lidar").xpos,
        data.site("lidar").xmat.reshape(3, 3),
        lidar.spec.angles,
    )
    directions = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles]) @ axes.T
    model.geom_group[[g for g in range(model.ngeom) if model.geom_bodyid[g] == 1]] = 5
    geoms, expected = meets(model, data, place, directions, (0, 1, 3))
    assert {g for g in geoms.tolist() if g in others} == set(others)
    expected[expected > 10.0] = np.inf
    np.testing.assert_allclose(lidar.scan(data), expected, atol=TOLERANCE)
    middles = np.linalg.norm(data.geom_xpos[others] - place, axis=1)
    nearest = np.array([expected[geoms == geom].min() for geom in others])
    for farthest in 0.5 * (nearest + middles):  # only the near side of one is within that
        short = Lidar(model, LidarSpec(beams=720, range_max=float(farthest)), "lidar", others)
        seen = np.where(expected <= farthest, expected, np.inf)
        np.testing.assert_allclose(short.scan(data), seen, atol=TOLERANCE)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5, math.pi])
def test_a_lidar_that_is_turned_looks_where_its_yaw_says(yaw: float) -> None:
    bearings = LidarSpec(beams=7, angle_max=3.0).bearings(yaw)
    assert np.exp(1j * bearings) == pytest.approx(np.exp(1j * (np.arange(-3.0, 3.5) + yaw)))
    assert np.abs(bearings).max() <= math.pi


def test_beams_of_a_scan_end_where_the_lidar_saw_something() -> None:
    # The lidar looks backwards: its middle beams go to where the rover comes from.
    ranges = np.array([np.inf, 2.0, np.inf], dtype=np.float32)
    north = (0.0, 0.0, math.sin(math.pi / 4), math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), north))
    assert scan_points(placed, LEO) == pytest.approx(np.array([[1.0, 1.0 + 0.174 - 2.0]]), abs=1e-3)
    on_its_left_side = (-math.sin(math.pi / 4), 0.0, 0.0, math.cos(math.pi / 4))
    placed = PlacedScan(LaserScan(0, ranges), Pose(0, (1.0, 1.0, 0.0), on_its_left_side))
    height = 0.79783  # of the lidar over the origin of the model frame
    expected = np.array([[1.0 + 0.174 - 2.0, 1.0 + height]])
    assert scan_points(placed, LEO) == pytest.approx(expected, abs=1e-3)
