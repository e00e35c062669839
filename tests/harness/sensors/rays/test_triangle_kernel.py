"""Rays against triangles: mj_ray on the same mesh, and rays whose hits are known."""

import math

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.arrays import triangle_arrays
from harness.sensors.rays.triangle_kernel import build_tree, cast_triangles
from tests.harness.sensors.mujoco_rays import meets

Array = NDArray[np.float64]
GROUP = 1
UNIT = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])


def scene(rng: np.random.Generator, meshes: int) -> tuple[mujoco.MjModel, mujoco.MjData]:
    """Hulls and open surfaces at random places; a sphere among them is none of the kernel's."""
    spec = mujoco.MjSpec()
    body = spec.worldbody.add_body(name="obstacles", pos=[0.3, -0.2, 0.1], quat=[0.9, 0.1, 0.2, 0.3])
    for index in range(meshes):
        points = rng.normal(size=(8, 3)) * rng.uniform(0.1, 1.5)
        faces = rng.permuted(np.tile(np.arange(8), (12, 1)), axis=1)[:, :3] if index % 2 else np.empty(0)
        vertices, triangles = points.ravel().tolist(), faces.ravel().astype(int).tolist()
        mesh = spec.add_mesh(name=f"m{index}", uservert=vertices, userface=triangles)
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        kind, place, turn = mujoco.mjtGeom.mjGEOM_MESH, rng.uniform(-4, 4, 3), rng.normal(size=4)
        body.add_geom(type=kind, meshname=mesh.name, pos=place, quat=turn, group=GROUP)
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.1, 0, 0], group=GROUP)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    model.geom_group[-1 if model.geom_type[-1] == mujoco.mjtGeom.mjGEOM_SPHERE else 0] = 3
    return model, data


def cast(tree: tuple[Array, Array], origin: Array, directions: Array, limit: float = 50.0) -> Array:
    ranges = np.full(len(directions), np.inf)
    cast_triangles(*tree, origin, np.ascontiguousarray(directions), limit, ranges)
    return ranges


@pytest.mark.parametrize("meshes", [1, 3, 30])
def test_random_rays_meet_mujoco(meshes: int) -> None:
    rng = np.random.default_rng(meshes)
    model, data = scene(rng, meshes)
    tree = triangle_arrays(model, GROUP)
    assert tree is not None
    met = 0
    for _ in range(40):
        origin, rays = rng.uniform(-5, 5, 3), rng.normal(size=(12, 3))
        rays[:6] = np.vstack([np.eye(3), -np.eye(3)])
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        _, theirs = meets(model, data, origin, rays, (GROUP,))
        np.testing.assert_allclose(cast(tree, origin, rays), theirs, atol=1e-5, rtol=0)
        met += int(np.isfinite(theirs).sum())
    assert met > 10


def test_a_triangle_is_met_from_both_sides_on_its_edges_and_within_the_range() -> None:
    tree = build_tree(UNIT)
    down, up = np.array([[0.0, 0, -1]]), np.array([[0.0, 0, 1]])
    met_at = {(0.2, 0.3): 1, (0.0, 0.0): 1, (0.5, 0.5): 1, (0.6, 0.5): 0, (-1e-6, 0.5): 0, (1.0, 0.0): 1}
    for (x, y), met in met_at.items():
        for height, ray in ((2.0, down), (-2.0, up)):
            (distance,) = cast(tree, np.array([x, y, height]), ray)
            assert distance == (2.0 if met else math.inf), (x, y)
    assert cast(tree, np.array([0.2, 0.2, 2.0]), down, 1.99)[0] == math.inf
    assert cast(tree, np.array([0.2, 0.2, 2.0]), down, 2.0)[0] == 2.0
    assert cast(tree, np.array([0.2, 0.2, 2.0]), up)[0] == math.inf
    along = np.array([[1.0, 0, 0]])
    assert cast(tree, np.array([-1.0, 0.2, 0.0]), along)[0] == math.inf  # in its plane: no hit
    ranges = np.array([1.0, 9.0])  # what is nearer already stays
    cast_triangles(*tree, np.array([0.2, 0.2, 2.0]), np.repeat(down, 2, axis=0), 50.0, ranges)
    assert ranges.tolist() == [1.0, 2.0]


def test_no_ray_slips_through_between_two_triangles() -> None:
    rng = np.random.default_rng(8)
    square = np.array([[[0.0, 0, 0], [1, 0, 0.3], [1, 1, 0.7]], [[0.0, 0, 0], [1, 1, 0.7], [0, 1, 0.1]]])
    along = rng.uniform(0.01, 0.99, (400, 1)) * (1.0, 1.0, 0.7)
    origin = np.array([0.37, 0.21, 2.3])
    apart = along - origin
    lengths = np.linalg.norm(apart, axis=1)
    assert cast(build_tree(square), origin, apart / lengths[:, None]) == pytest.approx(lengths)
