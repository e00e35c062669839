"""What is told to be clear, against where the exact walk finds the ground."""

import numpy as np
import pytest
from numpy.typing import NDArray

from harness.sensors.rays import horizon_kernel
from harness.sensors.rays.arrays import heightfield_arrays
from harness.sensors.rays.heightfield_kernel import cast_rays
from harness.sensors.rays.horizon_kernel import RINGS, SECTORS
from tests.harness.sensors.plain_python import as_plain_python
from tests.harness.sensors.test_lidar import terrain_spec

Array = NDArray[np.float64]
RANGE_MAX = 30.0


def ways(
    heights: Array,
    cell: float,
    origin: Array,
    directions: Array,
    kernels: object = horizon_kernel,
    range_max: float = RANGE_MAX,
    stretch: float = 1.0,
) -> tuple[Array, Array]:
    """How far the rays are clear, and how far they go; cells are `stretch` times as long along x."""
    terrain = heightfield_arrays(terrain_spec(heights, cell).compile())
    frame = terrain[3]
    frame[0, 0], frame[1, 0] = frame[0, 0] * stretch, frame[1, 0] / stretch
    profile, clear = np.empty((SECTORS, RINGS)), np.empty(len(directions))
    rest = terrain[1:]
    kernels.highest_points(heights.shape, *rest, origin, range_max, profile)  # type: ignore[attr-defined]
    kernels.clear_ways(profile, terrain[3], origin, directions, range_max, clear)  # type: ignore[attr-defined]
    found = np.full(len(directions), np.inf)
    cast_rays(*terrain, origin, directions, np.zeros(len(directions)), range_max, found)
    return clear, found


def around(elevations: tuple[float, ...], count: int) -> Array:
    azimuth, elevation = np.meshgrid(np.linspace(-np.pi, np.pi, count), elevations)
    level = np.cos(elevation)
    vectors = [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)]
    return np.stack(vectors, -1).reshape(-1, 3)


ALL_AROUND = around((-1.5, -0.6, -0.2, -0.02, 0.0, 0.05, 0.4, 1.5), 97)


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
    assert min(np.mean(near) for near in walked) > 0.7
    assert np.mean(walked) > 0.8


def test_a_single_peak_is_in_nobodys_way_unseen() -> None:
    rng, n, cell = np.random.default_rng(6), 65, 0.1
    for _ in range(30):
        heights, (row, col) = np.zeros((n, n)), rng.integers(2, n - 2, 2)
        heights[row, col] = 2.0
        peak = (np.array([col, row]) - (n - 1) / 2) * cell
        targets = np.column_stack([peak + cell * rng.uniform(-0.5, 0.5, (40, 2)), np.full(40, 0.6)])
        origin = np.append(rng.uniform(-3.0, 3.0, 2), 0.5)
        if np.hypot(*(peak - origin[:2])) < 3 * cell:
            continue
        directions = (targets - origin) / np.linalg.norm(targets - origin, axis=1, keepdims=True)
        clear, found = ways(heights, cell, origin, directions)
        assert (clear <= found).all()
        assert np.isfinite(found).mean() > 0.5


def test_a_peak_narrower_than_a_sector_is_in_the_way_of_its_own_sector() -> None:
    rng, n, cell = np.random.default_rng(2), 257, 0.1
    heights, azimuths = np.zeros((n, n)), rng.uniform(-np.pi, np.pi, 60)
    around_middle = np.rint(120.0 * np.column_stack([np.cos(azimuths), np.sin(azimuths)])).astype(int)
    heights[tuple((around_middle + n // 2).T[::-1])] = 2.0
    targets = np.column_stack([cell * around_middle, np.full(60, 0.6)])
    origin = np.array([0.0, 0.0, 0.5])
    directions = (targets - origin) / np.linalg.norm(targets - origin, axis=1, keepdims=True)
    clear, found = ways(heights, cell, origin, directions)
    assert (clear <= found).all()
    assert np.isfinite(found).all()


@pytest.mark.parametrize("place", [(50.0, 0.0, 5.0), (0.0, -50.0, 5.0), (0.0, 0.0, -0.5)])
def test_from_beside_the_map_or_under_the_ground_nothing_is_clear(place: tuple[float, ...]) -> None:
    clear, _ = ways(np.zeros((30, 30)), 0.2, np.array(place), ALL_AROUND)
    assert (clear == 0.0).all()


def test_what_is_compiled_is_what_python_does(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = as_plain_python("harness.sensors.rays.horizon_kernel", monkeypatch)
    heights = np.random.default_rng(4).normal(size=(17, 17)) * 0.2
    origin, some = np.array([0.13, -0.2, 0.9]), np.ascontiguousarray(ALL_AROUND[::5])
    assert np.array_equal(ways(heights, 0.3, origin, some, plain), ways(heights, 0.3, origin, some))
