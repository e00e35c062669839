"""What is told to be clear, against where the exact walk finds the ground."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays.arrays import heightfield_arrays
from harness.sensors.rays.bundle import sorted_into_bins
from harness.sensors.rays.cone_kernel import clear_ways
from harness.sensors.rays.heightfield_kernel import cast_rays
from tests.harness.sensors.test_lidar import terrain_spec

Array = NDArray[np.float64]
RANGE_MAX = 30.0


def ways(
    heights: Array,
    cell: float,
    origin: Array,
    directions: Array,
    range_max: float = RANGE_MAX,
    stretch: float = 1.0,
) -> tuple[Array, Array]:
    """How far the rays are clear, and how far they go; cells are `stretch` times as long along x."""
    terrain = heightfield_arrays(terrain_spec(heights, cell).compile())
    frame = terrain[3]
    frame[0, 0], frame[1, 0] = frame[0, 0] * stretch, frame[1, 0] / stretch
    clear, found = np.empty(len(directions)), np.full(len(directions), np.inf)
    order = sorted_into_bins(directions)[0]
    clear_ways(heights.shape, *terrain[1:], origin, directions, order, range_max, found, clear)
    cast_rays(*terrain, origin, directions, np.zeros(len(directions)), range_max, found)
    begun = np.full(len(directions), np.inf)
    cast_rays(*terrain, origin, directions, clear, range_max, begun)
    np.testing.assert_array_equal(begun, found)  # where walks begin changes no bit of a hit
    return clear, found


def around() -> Array:
    """Rays to all sides, at elevations from nearly straight down to nearly straight up."""
    elevations = (-1.5, -0.6, -0.2, -0.02, 0.0, 0.05, 0.4, 1.5)
    azimuth, elevation = np.meshgrid(np.linspace(-np.pi, np.pi, 721), elevations)
    level = np.cos(elevation)
    vectors = [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)]
    return np.stack(vectors, -1).reshape(-1, 3)


ALL_AROUND = around()


def test_no_ray_is_told_to_be_clear_farther_than_it_goes_and_most_are_nearly_as_far() -> None:
    rng = np.random.default_rng(3)
    walked = []
    for n, cell, relief, stretch, reach in (
        (5, 1.0, 1.0, 1.0, RANGE_MAX),
        (40, 0.1, 0.3, 1.0, RANGE_MAX),
        (90, 0.3, 2.0, 1.0, RANGE_MAX),
        (300, 0.05, 0.6, 1.0, RANGE_MAX),
        (60, 0.2, 0.5, 4.0, 5.0),
        (60, 0.8, 2.0, 0.25, 5.0),
    ):
        rolling = np.cumsum(np.cumsum(rng.normal(size=(n, n)), axis=0), axis=1)
        heights = relief * rolling / np.ptp(rolling)
        for x, y, above in ((0.0, 0.0, 0.8), (0.31, -0.24, 0.05), (-0.49, 0.2, 3.0)):
            place = (np.array([y, x]) + 0.5) * (n - 1)
            ground = heights[tuple(place.astype(int))]
            side = cell * (n - 1)
            origin = np.array([x * side * stretch, y * side, ground + above])
            clear, found = ways(heights, cell, origin, ALL_AROUND, range_max=reach, stretch=stretch)
            assert (clear <= found).all()
            walked.append(np.minimum(found, reach) - np.minimum(clear, reach) < 2.0)
    assert np.mean(walked) > 0.5


@pytest.mark.parametrize("place", [(50.0, 0.0, 5.0), (0.0, -50.0, 5.0), (0.0, 0.0, -0.5)])
def test_from_beside_the_map_or_under_the_ground_nothing_is_clear(place: tuple[float, ...]) -> None:
    clear, _ = ways(np.zeros((30, 30)), 0.2, np.array(place), ALL_AROUND)
    assert (clear == 0.0).all()
