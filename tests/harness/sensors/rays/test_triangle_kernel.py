"""Rays against triangles: mj_ray on the same mesh, and rays whose hits are known."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.triangle_kernel import build_tree, cast_triangles

Array = NDArray[np.float64]
UNIT = np.array([[[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]])


def cast(tree: tuple[Array, Array], origin: Array, directions: Array, limit: float = 50.0) -> Array:
    ranges = np.full(len(directions), np.inf)
    cast_triangles(*tree, origin, np.ascontiguousarray(directions), limit, ranges)
    return ranges


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
