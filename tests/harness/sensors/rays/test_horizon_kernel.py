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
    begun = np.full(len(directions), np.inf)
    cast_rays(*terrain, origin, directions, clear, range_max, begun)
    np.testing.assert_allclose(begun, found, rtol=0.0, atol=1e-9)  # where walks begin changes no hit
    return clear, found


def around(elevations: tuple[float, ...], count: int) -> Array:
    azimuth, elevation = np.meshgrid(np.linspace(-np.pi, np.pi, count), elevations)
    level = np.cos(elevation)
    vectors = [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)]
    return np.stack(vectors, -1).reshape(-1, 3)


def aim(pseudo_angle: Array) -> Array:
    """Points of the square |u| + |v| = 1 at angles of 0..4, one a quarter; shape (..., 2)."""
    quarter = [pseudo_angle < n for n in (1, 2, 3, 4)]
    u = np.select(quarter, [1 - pseudo_angle, 1 - pseudo_angle, pseudo_angle - 3, pseudo_angle - 3])
    v = np.select(quarter, [pseudo_angle, 2 - pseudo_angle, 2 - pseudo_angle, pseudo_angle - 4])
    return np.stack([u, v], axis=-1)


INNER = np.append(0.0, 4.0 * 1.25 ** np.arange(RINGS - 1))  # [cells]
OUTER = np.append(INNER[1:], np.inf)
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


def test_a_ray_is_clear_up_to_the_ring_in_which_it_comes_down_to_the_highest_point() -> None:
    """Of a profile with one high part; the map's cells are 0.5 m and 0.25 m, its unit of height 2 m."""
    rng, frame = np.random.default_rng(1), np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 0.5], [-1.0, 9.0, 0.0]])
    origin = np.array([5.0, 6.0, 7.0])
    height, outcomes = 0.5 * (7.0 - 3.0), set()
    for _ in range(300):
        sector, ring, high = rng.integers(SECTORS), rng.integers(RINGS), rng.uniform(-2.0, 4.0)
        seen = (sector + rng.integers(2)) % SECTORS
        reach = rng.choice([200.0, 20_000.0])  # the last ring begins at 3231 cells
        slope = rng.choice([-1.0, 1.0]) * rng.uniform(0.0, 0.05)  # unit of height a cell
        cells = aim(np.array((seen + rng.uniform(0.1, 0.9)) / 64))
        ray = np.array([*cells, slope * np.hypot(*cells)]) / (2.0, 4.0, 0.5)
        pace = np.hypot(*cells) / np.linalg.norm(ray)  # cells a metre
        profile, clear = np.full((SECTORS, RINGS), -np.inf), np.empty(1)
        profile[sector, ring] = high
        ray /= np.linalg.norm(ray)
        horizon_kernel.clear_ways(profile, frame, origin, ray[None], reach, clear)
        lowest = height + slope * (OUTER[ring] if slope < 0.0 else INNER[ring])
        met = seen == sector and lowest <= high and INNER[ring] <= reach * pace
        comes_down = slope < 0.0 and OUTER[-2] <= reach * pace  # the last ring has no end
        nearest = INNER[ring] if met else INNER[-1] if comes_down else np.inf
        assert clear[0] == pytest.approx(nearest / pace), (sector, ring, seen, slope)
        outcomes.add((seen == sector, met, slope < 0.0))
    assert len(outcomes) == 6


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


def test_of_a_map_of_one_cell_nothing_is_known() -> None:
    clear, found = ways(np.array([[0.0, 0.3], [0.2, 1.0]]), 4.0, np.array([0.5, 0.3, 2.0]), ALL_AROUND)
    assert (clear == 0.0).all()
    assert np.isfinite(found).any()


def test_what_is_compiled_is_what_python_does(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = as_plain_python("harness.sensors.rays.horizon_kernel", monkeypatch)
    heights = np.random.default_rng(4).normal(size=(17, 17)) * 0.2
    origin, some = np.array([0.13, -0.2, 0.9]), np.ascontiguousarray(ALL_AROUND[::5])
    assert np.array_equal(ways(heights, 0.3, origin, some, plain), ways(heights, 0.3, origin, some))
