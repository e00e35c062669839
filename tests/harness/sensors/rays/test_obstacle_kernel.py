"""The fan of beams against mj_ray, obstacle by obstacle."""

import math

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.arrays import obstacle_arrays
from harness.sensors.rays.bundle import sorted_into_bins
from harness.sensors.rays.obstacle_kernel import cast_bundle
from tests.harness.sensors.mujoco_rays import meets

Array = NDArray[np.float64]

BEAMS, RANGE_MAX = 61, 4.0
FIRST, STEP = -math.pi, 2 * math.pi / (BEAMS - 1)
SHAPES = (
    mujoco.mjtGeom.mjGEOM_BOX,
    mujoco.mjtGeom.mjGEOM_CYLINDER,
    mujoco.mjtGeom.mjGEOM_ELLIPSOID,
    mujoco.mjtGeom.mjGEOM_CAPSULE,
)


def scene(*geoms: dict[str, object]) -> tuple[mujoco.MjModel, mujoco.MjData]:
    spec = mujoco.MjSpec()
    spec.worldbody.add_geom(type=SHAPES[0], size=[9, 9, 0.1], pos=[0, 0, -5], group=0)  # not seen
    for geom in geoms:
        spec.worldbody.add_geom(**({"group": 1} | geom))
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def fans(world: tuple[mujoco.MjModel, mujoco.MjData], origin: Array, turn: Array) -> tuple[Array, Array]:
    """Our ranges and MuJoCo's, of a fan in the xy plane of a frame."""
    model, data = world
    angles = FIRST + STEP * np.arange(BEAMS)
    local = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(BEAMS)])
    ours, beams = np.full(BEAMS, np.inf), local @ turn.T
    poses = data.geom_xpos, data.geom_xmat, np.ascontiguousarray(np.vstack([origin, turn]))
    order, starts, grid = sorted_into_bins(local)
    obstacles = obstacle_arrays(model, 1)
    cast_bundle(*obstacles, *poses, beams, order, starts, grid, RANGE_MAX, ours)
    _, theirs = meets(model, data, origin, beams, (1,))
    theirs[theirs > RANGE_MAX] = np.inf
    return ours, theirs


def test_a_fan_meets_mujoco() -> None:
    """From outside and from within, level and tilted, over and beside, behind one another."""
    rng = np.random.default_rng(0)
    hits = misses = 0
    for tilt in (0.0, 0.1, 1.0) * 8:
        geoms = [
            {
                "type": shape,
                "size": rng.uniform(0.1, 0.9, 3),
                "pos": [*rng.uniform(-3, 3, 2), rng.uniform(-0.8, 0.8)],
                "quat": rng.normal(size=4) if tilt else [1, 0, 0, 0],
            }
            for shape in SHAPES * 2
        ]
        turn, quaternion = np.empty(9), np.array([1.0, *(tilt * rng.normal(size=2)), rng.normal()])
        mujoco.mju_quat2Mat(turn, quaternion / np.linalg.norm(quaternion))
        world, origin = scene(*geoms), rng.uniform(-1, 1, 3)
        ours, theirs = fans(world, origin, turn.reshape(3, 3))
        np.testing.assert_allclose(ours, theirs, rtol=0.0, atol=1e-9)
        hits, misses = hits + np.isfinite(ours).sum(), misses + np.isinf(ours).sum()
    assert min(hits, misses) > 200


def test_what_is_nearer_already_stays_and_without_obstacles_all_does() -> None:
    model, data = scene({"type": SHAPES[0], "size": [0.5] * 3, "pos": [2.0, 0.0, 0.0]})
    ranges, beams = np.array([1.0, 1.6]), np.tile([1.0, 0.0, 0.0], (2, 1))
    poses = data.geom_xpos, data.geom_xmat, np.vstack([np.zeros(3), np.eye(3)])
    order, starts, grid = sorted_into_bins(beams)
    for group, expected in ((2, 1.6), (1, 1.5)):
        obstacles = obstacle_arrays(model, group)
        cast_bundle(*obstacles, *poses, beams, order, starts, grid, 9.0, ranges)
        assert ranges == pytest.approx([1.0, expected])
