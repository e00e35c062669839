"""Bundles of rays in any directions against mj_multiRay over the whole scene."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.bundle import RayBundle, Surroundings
from tests.harness.sensors.mujoco_rays import meets
from tests.harness.sensors.test_lidar import (
    Scene,
    add_random_obstacles,
    add_rover,
    compiled,
    flat_scene,
    place_rover,
    terrain_spec,
)

Array = NDArray[np.float64]
TOLERANCE = 1e-5  # [m]
RANGE_MAX = 8.0


def pose_of(scene: Scene) -> Array:
    model, data = scene
    site = model.site("lidar").id
    return np.vstack([data.site_xpos[site], data.site_xmat[site].reshape(3, 3)])


def multi_ray(scene: Scene, directions: Array) -> tuple[Array, NDArray[np.bool_]]:
    """MuJoCo's distances, and which of them are to obstacles."""
    model, data = scene
    pose = pose_of(scene)
    geoms, distances = meets(model, data, pose[0], directions @ pose[1:].T, (0, 1))
    distances[distances > RANGE_MAX] = np.inf
    return distances, np.isfinite(distances) & (model.geom_group[geoms] == 1)


def spread(rng: np.random.Generator, n: int, flatness: float) -> Array:
    vectors = rng.normal(size=(n, 3)) * (1.0, 1.0, flatness)
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def test_random_bundles_meet_mujoco() -> None:
    """Random worlds and poses: level to overturned, over, on and under the ground, off the map."""
    rng = np.random.default_rng(17)
    on_ground = on_obstacle = 0
    for n, cell in ((9, 0.5), (33, 0.1), (80, 0.05), (130, 0.1)):
        half = cell * (n - 1) / 2
        world = terrain_spec(rng.choice([0.03, 0.3]) * rng.normal(size=(n, n)), cell)
        add_random_obstacles(world, rng, 1.2 * half)
        add_rover(world, 0.5)
        scene = compiled(world)
        surroundings = Surroundings(scene[0])
        for tilt in (0.0, 0.1, 2.0) * 8:
            directions = spread(rng, 500, rng.choice([0.0, 0.1, 1.0]))
            place_rover(
                scene, np.append(rng.uniform(-1.2, 1.2, 2) * half, rng.uniform(-0.8, 0.8)), tilt, rng
            )
            bundle = RayBundle(surroundings, directions, RANGE_MAX)
            ours = bundle.cast(scene[1], pose_of(scene))
            theirs, obstacle = multi_ray(scene, directions)
            np.testing.assert_array_equal(np.isfinite(ours), np.isfinite(theirs))
            hit = np.isfinite(theirs)
            np.testing.assert_allclose(ours[hit], theirs[hit], rtol=0.0, atol=TOLERANCE)
            np.testing.assert_array_equal(bundle.on_obstacle, obstacle)
            np.testing.assert_allclose(ours[obstacle], theirs[obstacle], rtol=0.0, atol=1e-9)
            on_ground, on_obstacle = on_ground + (hit & ~obstacle).sum(), on_obstacle + obstacle.sum()
    assert min(on_ground, on_obstacle) > 400


def test_rays_along_the_axes_of_the_bins_meet_a_wall() -> None:
    scene = flat_scene((2.0, 0.1, 1.0))
    axes = np.vstack([np.eye(3), -np.eye(3)])
    ranges = RayBundle(Surroundings(scene[0]), axes, RANGE_MAX).cast(scene[1], pose_of(scene))
    assert ranges == pytest.approx([np.inf] * 3 + [1.9, np.inf, 0.5])  # the site looks backwards
