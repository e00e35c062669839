"""What the kernels are given of a model: heights of its terrain, and maxima over blocks of its cells."""

import mujoco
import numpy as np
import pytest

from harness.sensors.rays.arrays import heightfield_arrays


def two_fields(heights: np.ndarray) -> mujoco.MjModel:
    """A model whose terrain is its second heightfield."""
    spec = mujoco.MjSpec()
    for name, values in (("other", np.linspace(0.0, 1.0, 6).reshape(2, 3)), ("terrain", heights)):
        rows, cols = values.shape
        size = [cols / 2, rows / 2, 1.0, 0.5]
        spec.add_hfield(name=name, size=size, nrow=rows, ncol=cols, userdata=values.ravel().tolist())
        spec.worldbody.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_HFIELD, hfieldname=name)
    return spec.compile()


@pytest.mark.parametrize(
    ("shape", "blocks"),
    [
        ((2, 2), []),
        ((3, 6), [(1, 3), (1, 2), (1, 1)]),
        ((6, 4), [(3, 2), (2, 1), (1, 1)]),
        ((150, 2), [(75, 1), (38, 1), (19, 1), (10, 1), (5, 1), (3, 1)]),  # 64 cells are the coarsest
    ],
)
def test_each_level_holds_the_highest_vertex_of_blocks_of_twice_as_many_cells(
    shape: tuple[int, int], blocks: list[tuple[int, int]]
) -> None:
    expected = np.random.default_rng(sum(shape)).random(shape).astype(np.float32)
    expected[0, 0], expected[-1, -1] = 0.0, 1.0  # heights that MuJoCo keeps as they are
    heights, maxima, levels, _ = heightfield_arrays(two_fields(expected))
    np.testing.assert_array_equal(heights, expected)
    assert len(levels) == 1 + len(blocks)
    for level, (rows, cols) in enumerate(blocks, start=1):
        start, width = levels[level]
        cells = 2**level
        highest = [
            [heights[r : r + cells + 1, c : c + cells + 1].max() for c in range(0, shape[1] - 1, cells)]
            for r in range(0, shape[0] - 1, cells)
        ]
        assert width == cols
        np.testing.assert_array_equal(maxima[start : start + rows * cols].reshape(rows, cols), highest)
    assert maxima.size == sum(rows * cols for rows, cols in blocks)
