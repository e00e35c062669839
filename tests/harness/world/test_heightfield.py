"""Heights between vertices, filled gaps and coarser grids, against MuJoCo and scipy."""

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates, uniform_filter1d

from harness.world.heightfield import Heightfield, filled, resampled

Array = NDArray[np.float64]


def tops(ground: Heightfield, points: Array) -> list[float]:
    """Heights of MuJoCo's heightfield at points, by vertical rays [m]."""
    lowest, relief, spec = float(ground.heights.min()), float(np.ptp(ground.heights)), mujoco.MjSpec()
    rows, columns = ground.heights.shape
    data = ((ground.heights - lowest) / relief).ravel().tolist()
    size = [*ground.half_size, relief, 1.0]
    spec.add_hfield(name="terrain", size=size, nrow=rows, ncol=columns, userdata=data)
    kind = mujoco.mjtGeom.mjGEOM_HFIELD
    spec.worldbody.add_geom(type=kind, hfieldname="terrain", pos=[0.0, 0.0, lowest])
    model = spec.compile()
    state = mujoco.MjData(model)
    mujoco.mj_kinematics(model, state)
    down, hit = np.array([0.0, 0.0, -1.0]), np.zeros(1, dtype=np.int32)
    starts = np.column_stack([points, np.full(len(points), 100.0)])
    return [100.0 - mujoco.mj_ray(model, state, start, down, None, 1, -1, hit) for start in starts]


def test_heights_agree_with_mujoco_between_the_vertices() -> None:
    """Rows run with y, columns with x; one point has the height that it has among many, to the bit."""
    rng = np.random.default_rng(0)
    ground = Heightfield(rng.normal(0.0, 0.2, (41, 67)), 0.1)
    points = rng.uniform(-1.0, 1.0, (1000, 2)) * (np.array(ground.half_size) - 0.01)
    heights = ground.heights_at(*points.T)
    assert heights == pytest.approx(tops(ground, points), abs=1e-5)
    beyond = rng.uniform(-1.3, 1.3, (500, 2)) * ground.half_size
    vertices = np.stack(np.meshgrid(np.arange(-34, 35), np.arange(-21, 22)), axis=-1).reshape(-1, 2)
    moved = Heightfield(ground.heights, 0.1, (1.7, -0.4))
    x, y = (np.vstack([points, beyond, 0.1 * vertices]) + moved.middle).T
    assert [moved.height_at(*at) for at in zip(x, y, strict=True)] == moved.heights_at(x, y).tolist()
    assert moved.heights_at(*(points + moved.middle).T) == pytest.approx(heights, abs=1e-12)


def test_points_beyond_the_map_have_the_height_of_its_edge() -> None:
    ground = Heightfield(np.arange(12.0).reshape(3, 4), cell=0.5)
    assert ground.half_size == (0.75, 0.5)
    heights = [ground.height_at(x, y) for x, y in ((99.0, 99.0), (0.75, -99.0), (-99.0, -99.0))]
    assert heights == [11.0, 3.0, 0.0]


def pull_push(values: Array) -> Array:
    """What `filled` promises, by other means: means of blocks, then back between their middles."""
    if not np.isnan(values).any():
        return values
    coarse = np.full([(size + 1) // 2 for size in values.shape], np.nan)
    for row, column in np.ndindex(*coarse.shape):
        block = values[2 * row : 2 * row + 2, 2 * column : 2 * column + 2]
        if not np.isnan(block).all():
            coarse[row, column] = np.nanmean(block)
    middles = (np.indices(values.shape) - 0.5) / 2
    smooth = map_coordinates(pull_push(coarse), middles, order=1, mode="nearest")
    return np.where(np.isnan(values), smooth, values)


@pytest.mark.parametrize("shape", [(40, 57), (9, 8)])
def test_gaps_are_filled_by_a_pyramid_of_means(shape: tuple[int, int]) -> None:
    values = np.random.default_rng(0).normal(size=shape)
    values[2:7, 3:8] = np.nan
    values[-1, -1] = values[0, 1] = np.nan
    np.testing.assert_allclose(filled(values), pull_push(values), atol=1e-12)


@pytest.mark.parametrize(
    ("step", "shape"),
    # The last one reaches the edges, with means over five pixels.
    [((3.0, 3.0), (21, 20)), ((2.6, 1.2), (24, 50)), ((0.5, 4.4), (99, 14)), ((4.0, 4.0), (16, 16))],
)
def test_coarser_cells_are_means_around_their_places_in_the_middle(
    step: tuple[float, float], shape: tuple[int, int]
) -> None:
    values = np.random.default_rng(0).normal(size=(64, 61))
    expected = values
    for axis, stride in enumerate(step):
        expected = uniform_filter1d(expected, 2 * (round(stride) // 2) + 1, axis=axis, mode="nearest")
    down, across = (np.arange(count) - (count - 1) / 2 for count in shape)
    places = np.meshgrid(31.5 + step[0] * down, 30.0 + step[1] * across, indexing="ij")
    expected = map_coordinates(expected, places, order=1, mode="nearest")
    np.testing.assert_allclose(resampled(values, step, shape), expected, atol=1e-12)
