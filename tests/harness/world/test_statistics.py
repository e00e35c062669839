"""Slopes and roughness of a ground, against closed forms, a fitted plane and sums written out."""

import math
from dataclasses import astuple

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.statistics import Promise, RoughnessMap, reach, slopes
from tests.support.terrain_statistics import measure, residual_rms

AXIS = np.linspace(-10.0, 10.0, 201)
X, Y = np.meshgrid(AXIS, AXIS)


def test_a_plane_has_its_slope_everywhere_and_no_residual() -> None:
    ground = Heightfield(0.3 * X - 0.4 * Y, cell=0.1)
    steep = math.degrees(math.atan(0.5))
    assert astuple(measure(ground)) == pytest.approx((steep, steep, 0.0, 0.0, 0.0), abs=1e-12)
    assert RoughnessMap(ground).mean_square(0.5, -1.0) == pytest.approx(0.0, abs=1e-18)
    cone = slopes(Heightfield(np.hypot(X, Y), cell=0.1))
    assert np.median(cone) == pytest.approx(45.0, abs=0.1)


@pytest.mark.parametrize(
    ("cell", "window", "vertices"),
    [(0.05, 0.3, 3), (0.1, 0.3, 1), (0.1, 1.0, 5), (0.05, 1.0, 10), (0.5, 0.3, 1)],
)
def test_a_window_is_no_wider_than_it_says_but_three_vertices_at_least(
    cell: float, window: float, vertices: int
) -> None:
    assert reach(Heightfield(np.zeros((9, 9)), cell), window) == vertices


def test_the_residual_is_the_distance_to_the_best_fit_plane_at_the_window_centre() -> None:
    heights = np.random.default_rng(0).standard_normal((11, 11))
    u = np.arange(11) - 5.0
    columns = [np.ones(121), np.tile(u, 11), np.repeat(u, 11)]
    plane, *_ = np.linalg.lstsq(np.stack(columns, axis=1), heights.ravel(), rcond=None)
    expected = abs(heights[5, 5] - plane[0])
    assert residual_rms(Heightfield(heights, cell=0.1), 1.0) == pytest.approx(expected)


def test_a_promise_is_described_with_its_units() -> None:
    promise = Promise(
        slope_p50=(1, 2), slope_p95=(3, 4), rms_1m=(0.01, 0.02), obstacle_density=(0.1, 0.1)
    )
    assert promise.describe() == (
        "slope p50 1-2 deg, p95 3-4 deg, roughness 10-20 mm over 1 m, 0 mm over 0.3 m, "
        "10 obstacles per 100 m2"
    )


@pytest.mark.parametrize(("cell", "reach"), [(0.03, 5), (0.1, 1), (0.5, 1)])
def test_roughness_is_the_mean_square_residual_around_the_nearest_vertex_that_has_one(
    cell: float, reach: int
) -> None:
    """One vertex is 1 m high: its residual is 1 less its share of a window, of others their shares."""
    heights, count = np.zeros((41, 51)), (2 * reach + 1) ** 2
    heights[20, 25] = 1.0
    rough = RoughnessMap(Heightfield(heights, cell, (70.0, -90.0)))
    expected = ((1.0 - 1.0 / count) ** 2 + (count - 1) / count**2) / count
    for off in (0.0, 0.49 * cell, -0.49 * cell):
        assert rough.mean_square(70.0 + off, -90.0 - off) == pytest.approx(expected)
    assert rough.mean_square(70.0 + (2 * reach + 1) * cell, -90.0) == pytest.approx(0.0, abs=1e-12)
    heights[20, 2 * reach] = 1.0
    rough = RoughnessMap(Heightfield(heights, cell, (70.0, -90.0)))
    for x in (70.0 + (2 * reach - 25) * cell, 70.0 - 40 * cell):  # and beyond the map
        assert rough.mean_square(x, -90.0) == pytest.approx(expected)
