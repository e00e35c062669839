"""The map for navigation, against vertices and points that are tried one by one."""

import math

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, convex, orientation
from harness.world.occupancy import OCCUPIED, OccupancyMap, occupancy
from harness.world.world import World

SLOPE, STEP = math.radians(40.0), 0.07
HALF, CELL = 4.0, 0.1
FLAT = np.zeros((81, 81))


def mapped(*obstacles: Obstacle, heights: np.ndarray = FLAT, resolution: float = 0.05) -> OccupancyMap:
    world = World("made", Heightfield(heights, CELL), obstacles, 0, 0.5)
    return occupancy(world, SLOPE, STEP, resolution)


def inner(grid: OccupancyMap) -> np.ndarray:
    """Cells half a metre or more from the edge of the map, where a run ends."""
    middles = [(np.arange(n) + 0.5) * grid.resolution for n in grid.cells.shape]
    y, x = (np.abs(m - half) < half - 0.5 for m, half in zip(middles, grid.half_size[::-1], strict=True))
    return np.asarray(y[:, None] & x)


@pytest.mark.parametrize("resolution", [0.05, 0.07, 0.3])
@pytest.mark.parametrize("axis", [0, 1])
def test_ground_is_occupied_where_it_is_steep_or_steps_higher_than_the_rover_climbs(
    axis: int, resolution: float
) -> None:
    """Slopes are averaged over three vertices; a step goes over one cell, which may climb besides."""

    def on(profile: np.ndarray) -> OccupancyMap:
        heights = np.tile(profile, (81, 1))
        return mapped(heights=heights.T if axis else heights, resolution=resolution)

    for angle, is_free in ((38.0, True), (42.0, False)):
        grid = on(CELL * math.tan(math.radians(angle)) * np.arange(81.0))
        assert (grid.resolution, grid.half_size) == (resolution, (HALF, HALF))
        assert (grid.cells[inner(grid)] == 0).all() == is_free
        assert (grid.cells[~inner(grid)] == OCCUPIED).all()
    for rise in (-0.16, -0.14, 0.14, 0.16):  # 7 cm and a cell at 40 degrees are 15.4 cm
        grid = on(np.where(np.arange(81) < 40, 0.0, rise))
        taken = np.argwhere((grid.cells == OCCUPIED) & inner(grid))[:, 1 - axis]
        assert (len(taken) > 0) == (abs(rise) > 0.154)
        both = {int((HALF + x) / resolution + 1e-9) for x in (-CELL, 0.0)}  # the step's two vertices
        assert both <= {*taken.tolist()} or not len(taken)
        assert (np.abs((taken + 0.5) * resolution - HALF + 0.05) <= 0.1 + resolution).all()


def test_a_box_on_its_corner_covers_just_the_cells_that_it_overlaps() -> None:
    """Its outline is |x| + |y| <= r, and so is the nearest point of a cell, axis by axis."""
    half_size, turned = (0.325, 0.325, 0.4), orientation(math.pi / 4)
    grid = mapped(Obstacle(ObstacleKind.HAZARD, "box", half_size, (0.63, -1.21, 0.3), turned))
    middles = (np.arange(160) + 0.5) * 0.05 - HALF
    x, y = (np.maximum(np.abs(middles - c) - 0.025, 0.0) for c in (0.63, -1.21))
    expected = (y[:, None] + x <= 0.325 * math.sqrt(2.0)) | ~inner(grid)
    assert ((grid.cells == OCCUPIED) == expected).all()


@pytest.mark.parametrize(("height", "is_free"), [(0.06, True), (0.08, False)])
def test_a_rock_is_occupied_if_it_is_higher_than_the_rover_climbs(height: float, is_free: bool) -> None:
    ground = 1.5 + 0.1 * np.tile(np.linspace(-HALF, HALF, 81)[:, None], (1, 81))
    rock = Obstacle(ObstacleKind.ROCK, "ellipsoid", (0.2, 0.2, 0.1), (1.0, 0.5, 1.55 + height - 0.1))
    assert mapped(rock, heights=ground).is_free(1.0, 0.5) is is_free


def test_a_disc_is_as_free_as_the_cells_whose_middles_lie_in_it() -> None:
    rng = np.random.default_rng(0)
    cells = np.where(rng.random((4, 6)) < 0.2, OCCUPIED, 0).astype(np.int8)
    grid = OccupancyMap(cells, 1.0, (3.0, 2.0), (10.0, -8.0))
    for x, y, radius in rng.uniform((6.5, -10.5, 0.0), (13.5, -5.5, 2.5), (300, 3)):
        on_map = abs(x - 10.0) < 3.0 and abs(y + 8.0) < 2.0
        own = on_map and cells[int(y + 10.0), int(x - 7.0)] == OCCUPIED
        near = any(math.dist((x, y), (7.5 + c, -9.5 + r)) <= radius for r, c in np.argwhere(cells))
        assert grid.is_free(x, y, radius) is bool(on_map and not own and not near)
    assert not grid.is_free(math.nan, -8.0)
    assert not grid.is_free(10.0, math.nan)


def test_decks_and_what_is_high_above_the_ground_are_not_in_the_way_wherever_the_map_lies() -> None:
    corners = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-0.5, 0.5) for z in (0.0, 0.3)])
    last = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.1, 0.1), (102.0, -50.0, 5.0))
    ground = Heightfield(np.full((41, 41), 5.0), 0.25, (100.0, -50.0))
    hazard, deck = ObstacleKind.HAZARD, ObstacleKind.DECK
    for kind, height, is_free in ((hazard, 0.9, False), (hazard, 1.1, True), (deck, 0.0, True)):
        thing = convex(kind, corners + np.array([100.0, -50.0, 5.0 + height]))
        found = occupancy(World("w", ground, (thing, last), 0, None), 0.5, 0.1)
        places = ((100.0, -50.0), (102.0, -50.0), (101.5, -50.0), (0.0, 0.0))
        assert [found.is_free(*place) for place in places] == [is_free, False, True, False]
