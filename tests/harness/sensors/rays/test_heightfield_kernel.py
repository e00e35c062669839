"""The cell walk against mj_rayHfield, ray by ray, over everything a ray can do to a heightfield."""

import itertools

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.arrays import heightfield_arrays
from harness.sensors.rays.heightfield_kernel import cast_rays
from harness.world.heightfield import Heightfield

Array = NDArray[np.float64]
Rays = tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.int64], Array]

TOLERANCE = 1e-5  # [m]
FAR = 1e6  # [m]
BASE = 0.5  # [m] of solid ground below the lowest height


def terrain_model(
    heights: Array, cell: float, center: tuple[float, float] = (0.0, 0.0)
) -> tuple[mujoco.MjModel, mujoco.MjData]:
    rows, cols = heights.shape
    relief = max(float(np.ptp(heights)), 1e-3)
    spec, kind = mujoco.MjSpec(), mujoco.mjtGeom.mjGEOM_HFIELD
    spec.add_hfield(name="other", size=[1, 1, 1, 1], nrow=2, ncol=3, userdata=[0, 1, 0, 1, 1, 0])
    size = [cell * (cols - 1) / 2, cell * (rows - 1) / 2, relief, BASE]
    scaled = ((heights - heights.min()) / relief).ravel().tolist()
    spec.add_hfield(name="terrain", size=size, nrow=rows, ncol=cols, userdata=scaled)
    place = [*center, heights.min()]
    spec.worldbody.add_geom(name="terrain", type=kind, hfieldname="terrain", pos=place)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return model, data


def cast(rays: Rays, origin: Array, directions: Array, range_max: float = FAR) -> Array:
    ranges = np.full(len(directions), np.inf)
    cast_rays(*rays, origin, directions, np.zeros(len(directions)), range_max, ranges)
    return ranges


def mujoco_cast(scene: tuple[mujoco.MjModel, mujoco.MjData], origin: Array, directions: Array) -> Array:
    model, data = scene
    ranges = np.array([mujoco.mj_rayHfield(model, data, 0, origin, d, None) for d in directions])
    ranges[ranges < 0.0] = np.inf
    return ranges


def unit(directions: Array) -> Array:
    scaled: Array = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    return scaled


def stepped_heights(rng: np.random.Generator, n: int) -> Array:
    """Heights of 0..1 m in eighths: exact in float32, so that on a 0.25 m grid nothing rounds."""
    heights = rng.integers(0, 9, size=(n, n)) / 8.0
    heights[0, 0], heights[1, 1] = 0.0, 1.0
    return heights


def test_rays_along_grid_lines_and_through_vertices_never_leak() -> None:
    """On exact edges MuJoCo is ambiguous: about 1 ray in 100 slips between two of its triangles.

    So a differing ray is judged by MuJoCo's answers for the same ray shifted by 10 nm to all sides:
    ours must lie within them, and where MuJoCo lets it through, it must be a point of the surface.
    """
    rng = np.random.default_rng(3)
    shifts = np.array(list(itertools.product((-1e-8, 0.0, 1e-8), repeat=3)))
    steps = np.array([d for d in itertools.product(range(-2, 3), repeat=3) if any(d)], float)
    differing = total = 0
    for _ in range(4):
        ground = Heightfield(heights=stepped_heights(rng, 17), cell=0.25)
        scene = terrain_model(ground.heights, ground.cell)
        rays = heightfield_arrays(scene[0])
        for _ in range(250):
            corner = rng.integers(1, 16, 2) * 0.25 - 2.0
            origin = np.array([*corner, rng.choice([1.5, 1.25, 0.6, 0.5, 0.0625])])
            direction = unit(rng.choice(steps, 1))
            ours = cast(rays, origin, direction)[0]
            theirs = mujoco_cast(scene, origin, direction)[0]
            total += 1
            if ours == theirs or abs(ours - theirs) < TOLERANCE:
                continue
            differing += 1
            around = np.array([mujoco_cast(scene, origin + s, direction)[0] for s in shifts])
            assert around.min() - TOLERANCE <= ours <= around.max() + TOLERANCE
            if ours < theirs:
                x, y, z = origin + ours * direction[0]
                assert z == pytest.approx(ground.height_at(x, y), abs=1e-9)
    assert differing < 0.03 * total


def test_only_nearer_hits_within_range_are_written() -> None:
    rays = heightfield_arrays(terrain_model(np.zeros((3, 3)), 1.0)[0])
    origin, down = np.array([0.3, 0.2, 0.5]), np.tile([0.0, 0.0, -1.0], (3, 1))
    ranges = np.array([np.inf, 0.4, 0.6])
    cast_rays(*rays, origin, down, np.zeros(3), 10.0, ranges)
    assert ranges == pytest.approx([0.5, 0.4, 0.5])
    assert (cast(rays, origin, down, range_max=0.49) == np.inf).all()
