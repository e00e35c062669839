"""The lidar against mj_multiRay over the whole scene, and what its ranges say (REP-117)."""

from itertools import cycle, islice

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.robots import ROVERS, RoverSpec
from harness.sensors.lidar import Lidar
from harness.sensors.lidar_spec import LidarSpec

Array = NDArray[np.float64]
Scene = tuple[mujoco.MjModel, mujoco.MjData]

TOLERANCE = 1e-5  # [m]
BOX, CYLINDER, ELLIPSOID, MESH = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_MESH,
)
YAWED_BY_PI = (0.0, 0.0, 0.0, 1.0)  # as both rovers carry it


def terrain_spec(heights: Array, cell: float) -> mujoco.MjSpec:
    n = len(heights)
    half, relief = cell * (n - 1) / 2, max(float(np.ptp(heights)), 1e-3)
    spec = mujoco.MjSpec()
    spec.add_hfield(
        name="terrain",
        size=[half, half, relief, 1.0],
        nrow=n,
        ncol=n,
        userdata=((heights - heights.min()) / relief).ravel().tolist(),
    )
    spec.worldbody.add_geom(
        name="terrain",
        type=mujoco.mjtGeom.mjGEOM_HFIELD,
        hfieldname="terrain",
        pos=[0.0, 0.0, heights.min()],
        group=0,
    )
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
    for shape in islice(cycle((BOX, CYLINDER, ELLIPSOID)), 15):
        obstacles.add_geom(
            type=shape,
            size=rng.uniform(0.05, 0.5, 3),
            pos=[*rng.uniform(-half, half, 2), rng.uniform(-0.2, 0.6)],
            quat=rng.normal(size=4),
            group=1,
        )
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


def mujoco_scan(scene: Scene, spec: LidarSpec) -> NDArray[np.float32]:
    model, data = scene
    site = model.site("lidar").id
    angles = np.linspace(-spec.angle_max, spec.angle_max, spec.beams)
    fan = np.column_stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)])
    beams = (fan @ data.site_xmat[site].reshape(3, 3).T).ravel()
    groups = np.array([1, 1, 0, 0, 0, 0], np.uint8)
    hit, distances = np.empty(spec.beams, np.int32), np.empty(spec.beams)
    origin = data.site_xpos[site]
    mujoco.mj_multiRay(
        model, data, origin, beams, groups, 1, -1, hit, distances, None, spec.beams, mujoco.mjMAXVAL
    )
    distances[(distances < 0.0) | (distances > spec.range_max)] = np.inf
    distances[distances < spec.range_min] = -np.inf
    return distances.astype(np.float32)


def assert_same_scan(ours: NDArray[np.float32], theirs: NDArray[np.float32]) -> None:
    hit = np.isfinite(theirs)
    np.testing.assert_array_equal(ours[~hit], theirs[~hit])
    np.testing.assert_allclose(ours[hit], theirs[hit], rtol=0.0, atol=TOLERANCE)


@pytest.mark.parametrize("rover", ROVERS.values(), ids=ROVERS.keys())
@pytest.mark.parametrize("cell", [0.05, 0.1, 0.5])
def test_a_thousand_random_scans_meet_mujoco(rover: RoverSpec, cell: float) -> None:
    """Random worlds and poses: level to overturned, over, on and under the ground, off the map."""
    rng = np.random.default_rng([int(1000 * rover.lidar_height), int(100 * cell)])
    spec = LidarSpec(beams=48, range_max=float(rng.choice([3.0, 10.0])))
    finite = near = 0
    for _ in range(14):
        n = int(rng.integers(9, 40))
        half = cell * (n - 1) / 2
        world = terrain_spec(rng.choice([0.03, 0.2, 0.5]) * rng.normal(size=(n, n)), cell)
        add_random_obstacles(world, rng, 1.2 * half)
        add_rover(world, rover.lidar_height)
        scene = compiled(world)
        lidar = Lidar(scene[0], spec)
        for tilt in (0.0, 0.02, 0.1, 0.3, 2.0) * 3:
            height = rng.choice([-0.8, -0.3, 0.0, 0.3])
            place_rover(scene, np.array([*rng.uniform(-1.3, 1.3, 2) * half, height]), tilt, rng)
            ranges = lidar.scan(scene[1])
            assert_same_scan(ranges, mujoco_scan(scene, spec))
            finite += int(np.isfinite(ranges).sum())
            near += int((ranges == -np.inf).sum())
    assert finite > 1000
    assert near > 10


def test_thin_post_is_seen_all_around() -> None:
    # One thin post at a time, all around: also where azimuth wraps from pi to -pi.
    for azimuth in np.linspace(-np.pi, np.pi, 25):
        world = terrain_spec(np.zeros((3, 3)), 10.0)
        add_rover(world, 0.5)
        post = [4.0 * np.cos(azimuth), 4.0 * np.sin(azimuth), 0.5]
        world.worldbody.add_geom(type=CYLINDER, size=[0.05, 1.0, 0.0], pos=post, group=1)
        scene = compiled(world)
        ranges = Lidar(scene[0], LidarSpec()).scan(scene[1])
        assert_same_scan(ranges, mujoco_scan(scene, LidarSpec()))
        assert np.isfinite(ranges).sum() in {2, 3, 4}


def flat_scene(*walls: tuple[float, float, float]) -> Scene:
    """Flat ground with a rover at its middle and walls at x, of half thickness and half height."""
    world = terrain_spec(np.zeros((5, 5)), 10.0)
    add_rover(world, 0.5)
    for x, thickness, height in walls:
        world.worldbody.add_geom(type=BOX, size=[thickness, 3.0, height], pos=[x, 0.0, 0.0], group=1)
    return compiled(world)


def test_nothing_in_range_is_plus_infinity() -> None:
    model, data = flat_scene()
    assert (Lidar(model, LidarSpec()).scan(data) == np.inf).all()


def test_obstacle_nearer_than_range_min_is_minus_infinity() -> None:
    model, data = flat_scene((0.2, 0.1, 1.0))  # its face 0.1 m ahead
    ranges = Lidar(model, LidarSpec()).scan(data)
    assert ranges[0] == -np.inf
    assert ranges[len(ranges) // 2] == np.inf


@pytest.mark.parametrize(("face", "seen"), [(0.151, 0.151), (9.999, 9.999), (10.001, np.inf)])
def test_limits_of_the_range(face: float, seen: float) -> None:
    model, data = flat_scene((face + 0.1, 0.1, 1.0))
    assert Lidar(model, LidarSpec()).scan(data)[0] == pytest.approx(seen, abs=1e-6)


@pytest.mark.parametrize(("nearest", "farthest"), [(1.5, 4.0), (0.5, 1.5)])
def test_a_range_that_is_exactly_a_limit_is_a_range(nearest: float, farthest: float) -> None:
    model, data = flat_scene((2.0, 0.5, 1.0))
    spec = LidarSpec(range_min=nearest, range_max=farthest, angle_max=np.pi)
    assert Lidar(model, spec).scan(data)[0] == 1.5


def test_terrain_nearer_than_range_min_is_minus_infinity() -> None:
    model, data = flat_scene()
    data.qpos[2] = -0.5  # the lidar on the ground
    mujoco.mj_kinematics(model, data)
    assert (Lidar(model, LidarSpec()).scan(data) == -np.inf).all()


def test_nearest_of_obstacles_and_terrain_wins() -> None:
    model, data = flat_scene((4.0, 0.5, 1.0), (2.0, 0.5, 1.0), (3.0, 0.5, 0.4))
    assert Lidar(model, LidarSpec()).scan(data)[0] == pytest.approx(1.5)
    data.qpos[2], data.qpos[3:7] = 0.1, (np.cos(0.25), 0.0, np.sin(0.25), 0.0)  # nose down
    mujoco.mj_kinematics(model, data)
    scan = Lidar(model, LidarSpec()).scan(data)
    assert_same_scan(scan, mujoco_scan((model, data), LidarSpec()))
    assert scan[0] < 1.2  # the ground ahead of the first wall


def test_first_and_last_beam_look_ahead_and_coincide() -> None:
    model, data = flat_scene((2.0, 0.5, 1.0))
    ranges = Lidar(model, LidarSpec()).scan(data)
    assert ranges[0] == pytest.approx(1.5)  # a site yawed by pi: azimuth -pi is robot-forward
    assert ranges[-1] == pytest.approx(ranges[0], abs=1e-6)
    assert ranges[len(ranges) // 4] == np.inf  # to the left


def test_scan_runs_counter_clockwise_from_ahead() -> None:
    world = terrain_spec(np.zeros((3, 3)), 10.0)
    add_rover(world, 0.5)
    world.worldbody.add_geom(type=ELLIPSOID, size=[0.5] * 3, pos=[0.0, 3.0, 0.5], group=1)
    model, data = compiled(world)
    ranges = Lidar(model, LidarSpec(beams=361)).scan(data)
    assert np.nanargmin(ranges) == 90  # 90 degrees to the left


def test_moved_obstacle_is_seen_where_it_is_now() -> None:
    world = terrain_spec(np.zeros((3, 3)), 10.0)
    add_rover(world, 0.5)
    walker = world.worldbody.add_body(name="walker", mocap=True, pos=[3.0, 0.0, 0.5])
    walker.add_geom(type=BOX, size=[0.5] * 3, group=1)
    model, data = compiled(world)
    lidar = Lidar(model, LidarSpec())
    assert lidar.scan(data)[0] == pytest.approx(2.5)
    data.mocap_pos[0, 0] = 5.0
    mujoco.mj_kinematics(model, data)
    assert lidar.scan(data)[0] == pytest.approx(4.5)


def test_scans_are_arrays_of_their_own_and_repeat_to_the_bit() -> None:
    model, data = flat_scene((2.0, 0.5, 1.0))
    lidar = Lidar(model, LidarSpec())
    one, other = lidar.scan(data), lidar.scan(data)
    assert one is not other
    assert not np.shares_memory(one, other)
    assert one.dtype == np.float32
    assert one.tobytes() == other.tobytes()


def test_obstacle_of_unknown_shape_is_named() -> None:
    world = terrain_spec(np.zeros((3, 3)), 1.0)
    add_rover(world, 0.5)
    world.worldbody.add_geom(
        name="ball", type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0.0, 0.0], group=1
    )
    with pytest.raises(ValueError, match=r"'ball'.*available: box, cylinder, capsule, ellipsoid"):
        Lidar(world.compile(), LidarSpec())
