"""The map for navigation, against points that are tried one by one."""

import math

import numpy as np
import pytest

from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, Shape, convex, rotation_matrix, top
from harness.world.occupancy import OCCUPIED, OccupancyMap, occupancy
from harness.world.world import World

SLOPE, STEP = math.radians(40.0), 0.07
HALF, CELL = 4.0, 0.1
LEANING = (math.cos(0.4), 0.3 * math.sin(0.4), 0.0, math.sqrt(0.91) * math.sin(0.4))


def world(heights: np.ndarray | None = None, *obstacles: Obstacle) -> World:
    count = round(2 * HALF / CELL) + 1
    flat = np.zeros((count, count)) if heights is None else heights
    return World("made", Heightfield(flat, CELL), obstacles, 0, 0.5)


def middles(grid: OccupancyMap) -> np.ndarray:
    return (np.arange(len(grid.cells)) + 0.5) * grid.resolution - HALF


def axes() -> tuple[np.ndarray, np.ndarray]:
    """Row and column coordinates of the vertices: y, x."""
    y, x = np.meshgrid(*(np.linspace(-HALF, HALF, round(2 * HALF / CELL) + 1),) * 2, indexing="ij")
    return y, x


def test_flat_ground_is_free_but_for_the_edge_where_a_run_ends() -> None:
    grid = occupancy(world(), SLOPE, STEP)
    assert (grid.cells.shape, grid.resolution) == ((160, 160), 0.05)
    assert grid.cells.dtype == np.int8
    inner = np.abs(middles(grid)) < HALF - 0.5
    expected = np.where(inner & inner[:, None], 0, 100)  # of nav_msgs/OccupancyGrid, where -1 is unknown
    assert (grid.cells == expected).all()


@pytest.mark.parametrize("along", [0, 1])
@pytest.mark.parametrize(("degrees", "is_free"), [(39.0, True), (41.0, False)])
def test_a_slope_is_occupied_if_it_is_steeper_than_the_rover_climbs(
    along: int, degrees: float, is_free: bool
) -> None:
    heights = math.tan(math.radians(degrees)) * np.clip(axes()[along], 0.0, 2.0)
    grid = occupancy(world(heights), SLOPE, STEP)
    probe = (1.0, 0.3) if along else (0.3, 1.0)
    assert grid.is_free(*probe) is is_free
    assert grid.is_free(-1.0, -1.0)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("along", [0, 1])
@pytest.mark.parametrize(("excess", "is_free"), [(-0.005, True), (0.005, False)])
def test_a_step_is_occupied_on_either_side_if_it_is_higher_than_the_rover_climbs(
    sign: float, along: int, excess: float, is_free: bool
) -> None:
    rise = CELL * math.tan(SLOPE) + STEP + excess
    heights = sign * rise * (axes()[along] > 0.95)  # between the vertices at 0.9 and 1.0
    grid = occupancy(
        world(heights), math.radians(60.0), STEP + CELL * (math.tan(SLOPE) - math.tan(1.047))
    )
    for place in (0.92, 0.98):
        assert grid.is_free(*((place, 0.3) if along else (0.3, place))) is is_free
    assert grid.is_free(*((0.7, 0.3) if along else (0.3, 0.7)))


@pytest.mark.parametrize(
    ("shape", "half_size"),
    [("box", (0.5, 0.12, 0.4)), ("cylinder", (0.2, 0.5)), ("ellipsoid", (0.6, 0.3, 0.3))],
)
def test_a_hazard_covers_the_cells_below_it_and_no_others(
    shape: Shape, half_size: tuple[float, ...]
) -> None:
    hazard = Obstacle(ObstacleKind.HAZARD, shape, half_size, (0.63, -1.21, 0.3), LEANING)
    grid = occupancy(world(None, hazard), SLOPE, STEP)
    rng = np.random.default_rng(0)
    half = np.array(half_size if shape != "cylinder" else (half_size[0], *half_size))
    points = rng.uniform(-half, half, (200_000, 3))
    if shape == "ellipsoid":
        points = points[((points / half) ** 2).sum(axis=1) < 1.0]
    if shape == "cylinder":
        points = points[np.hypot(points[:, 0], points[:, 1]) < half[0]]
    seen = (points @ rotation_matrix(LEANING).T)[:, :2] + hazard.position[:2]
    column, row = ((seen + HALF) / grid.resolution).astype(int).T
    below = np.zeros(grid.cells.shape, dtype=bool)
    below[row, column] = True
    edge = np.abs(middles(grid)) > HALF - 0.5
    marked = (grid.cells == OCCUPIED) & ~edge & ~edge[:, None]
    assert marked[below].all()
    # The outline is a polygon, and a corner of a cell may be touched where no random point fell.
    grown = below.copy()
    for axis in (0, 1):
        grown |= np.roll(grown, 1, axis) | np.roll(grown, -1, axis)
    assert not (marked & ~grown).any()
    assert marked.sum() < 1.2 * below.sum() + 8


def test_a_box_on_its_corner_covers_just_the_cells_that_it_overlaps() -> None:
    """Its outline is |x| + |y| <= r, and so is the nearest point of a cell, axis by axis."""
    turned = (math.cos(math.pi / 8), 0.0, 0.0, math.sin(math.pi / 8))
    box = Obstacle(ObstacleKind.HAZARD, "box", (0.325, 0.325, 0.4), (0.63, -1.21, 0.3), turned)
    grid = occupancy(world(None, box), SLOPE, STEP)
    x, y = (np.maximum(np.abs(middles(grid) - c) - grid.resolution / 2, 0.0) for c in (0.63, -1.21))
    inner = np.abs(middles(grid)) < HALF - 0.5
    expected = (y[:, None] + x <= 0.325 * math.sqrt(2.0)) | ~inner | ~inner[:, None]
    assert ((grid.cells == OCCUPIED) == expected).all()


@pytest.mark.parametrize(("height", "is_free"), [(0.06, True), (0.08, False)])
def test_a_rock_is_occupied_if_it_is_higher_than_the_rover_climbs(height: float, is_free: bool) -> None:
    ground = 1.5 + 0.1 * axes()[0]
    rock = Obstacle(ObstacleKind.ROCK, "ellipsoid", (0.2, 0.2, 0.1), (1.0, 0.5, 1.55 + height - 0.1))
    grid = occupancy(world(ground, rock), SLOPE, STEP)
    assert grid.is_free(1.0, 0.5) is is_free
    assert top(rock) == pytest.approx(1.55 + height)


def test_a_disc_is_free_if_no_occupied_cell_lies_in_it_and_nothing_off_the_map_is() -> None:
    post = Obstacle(ObstacleKind.HAZARD, "box", (0.02, 0.02, 0.5), (1.025, 0.025, 0.5))
    grid = occupancy(world(None, post), SLOPE, STEP)
    assert not grid.is_free(1.025, 0.025)
    assert grid.is_free(1.2, 0.02)
    assert grid.is_free(1.025, 0.325, 0.29)
    assert not grid.is_free(1.025, 0.325, 0.31)
    assert not any(
        grid.is_free(x, y) for x, y in ((3.6, 0.0), (0.0, -9.0), (math.nan, 0.0), (0.0, math.nan))
    )


@pytest.mark.parametrize(
    ("x", "y", "radius", "is_free"),
    [
        (8.5, -9.5, 0.0, False),
        (8.9, -9.1, 0.0, False),
        (9.1, -9.5, 0.0, True),
        (8.5, -7.5, 2.0, False),  # the cell's middle is on the rim
        (8.5, -7.5, 1.999, True),
        (11.5, -9.5, 3.0, False),
        (11.5, -9.5, 2.999, True),
        (12.0, -9.5, 0.0, False),
        (11.9, -6.1, 0.0, True),
        (11.9, -6.0, 0.0, False),
    ],
)
def test_a_disc_is_as_free_as_the_cells_whose_middles_lie_in_it(
    x: float, y: float, radius: float, *, is_free: bool
) -> None:
    cells = np.zeros((4, 4), dtype=np.int8)
    cells[0, 0] = OCCUPIED
    grid = OccupancyMap(cells, 1.0, (2.0, 2.0), (10.0, -8.0))
    assert grid.is_free(x, y, radius) is is_free


@pytest.mark.parametrize("along", [0, 1])
def test_ripples_are_driven_over_if_the_mean_of_three_vertices_is_not_too_steep(along: int) -> None:
    """0, 1, 0, -1 dm: 45 deg from vertex to vertex; the means 0, 1/3, 0, -1/3 dm rise by 18 deg."""
    ripples = 0.1 * np.array([0.0, 1.0, 0.0, -1.0])[np.arange(81) % 4]
    heights = np.repeat(ripples[None], 81, axis=0)
    ground = world(heights if along else heights.T)
    steepest = math.degrees(math.atan(1.0 / 3.0))
    for limit, is_free in ((steepest + 0.1, True), (steepest - 0.1, False)):
        assert occupancy(ground, math.radians(limit), 0.2).is_free(0.02, 0.02) is is_free


@pytest.mark.parametrize("resolution", [0.5, 0.6])  # the last cell of 0.6 m is half off the map
def test_a_coarse_map_keeps_what_fine_ground_shows(resolution: float) -> None:
    heights = 0.5 * (np.hypot(*axes()) < 0.05)  # one vertex
    grid = occupancy(world(heights), SLOPE, STEP, resolution=resolution)
    assert not grid.is_free(0.1, 0.1)
    assert grid.is_free(1.1, 1.1)


def test_an_oblong_map_has_more_columns_than_rows_and_its_own_edges() -> None:
    heights = np.zeros((41, 81))  # 4 m along y, 8 m along x
    heights[20, 70] = 1.0  # x = 3, y = 0
    grid = occupancy(World("made", Heightfield(heights, CELL), (), 0, 0.5), SLOPE, STEP)
    assert grid.cells.shape == (80, 160)
    free = {
        place: grid.is_free(*place)
        for place in ((3.0, 0.0), (0.0, 1.4), (3.4, 1.0), (0.0, 1.6), (3.6, 0.9))
    }
    assert list(free.values()) == [False, True, True, False, False], free


def test_decks_and_what_is_high_above_the_ground_are_not_in_the_way_wherever_the_map_lies() -> None:
    ground = Heightfield(np.full((41, 41), 5.0), 0.25, (100.0, -50.0))
    corners = np.array([(x, y, z) for x in (-1.0, 1.0) for y in (-0.5, 0.5) for z in (0.0, 0.3)])

    def map_with(kind: ObstacleKind, height: float) -> OccupancyMap:
        thing = convex(kind, corners + np.array([100.0, -50.0, 5.0 + height]))
        last = Obstacle(ObstacleKind.HAZARD, "box", (0.1, 0.1, 0.1), (102.0, -50.0, 5.0))
        found = occupancy(World("w", ground, (thing, last), 0, None), 0.5, 0.1)
        assert not found.is_free(102.0, -50.0)
        return found

    assert not map_with(ObstacleKind.HAZARD, 0.9).is_free(100.0, -50.0)
    assert map_with(ObstacleKind.HAZARD, 0.9).is_free(101.5, -50.0)
    assert map_with(ObstacleKind.HAZARD, 1.1).is_free(100.0, -50.0)
    assert map_with(ObstacleKind.DECK, 0.0).is_free(100.0, -50.0)
    assert not map_with(ObstacleKind.DECK, 0.0).is_free(0.0, 0.0)
