"""Where drivers may wander between pits, and where a rover starts, against a search of all places."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis.extra.numpy import array_shapes, arrays

from harness.base.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind
from harness.world.solids.assembly import free_start
from harness.world.solids.surface import Surface, largest_rectangle, room_without_pits
from harness.world.world import Start, World


@settings(max_examples=40)
@given(arrays(bool, array_shapes(min_dims=2, max_dims=2, max_side=5)))
def test_no_rectangle_without_a_pit_is_larger(free: np.ndarray) -> None:
    rows, columns = (range(count + 1) for count in free.shape)
    areas = [
        (bottom - top) * (right - left)
        for top, bottom in combinations(rows, 2)
        for left, right in combinations(columns, 2)
        if free[top:bottom, left:right].all()
    ]
    top, bottom, left, right = largest_rectangle(free)
    if areas:
        assert free[top:bottom, left:right].all()
        assert (bottom - top) * (right - left) == max(areas)


def surface(has_floor: np.ndarray, cell: float = 0.5) -> Surface:
    ground = Heightfield(np.zeros(has_floor.shape), cell, (50.0, -20.0))
    return Surface(ground, np.zeros(0, bool), has_floor)


def test_the_room_of_drivers_is_measured_in_metres_where_the_map_lies() -> None:
    has_floor = np.ones((25, 41), bool)  # x from 40 to 60 m, y from -26 to -14 m
    assert room_without_pits(surface(has_floor)) is None
    has_floor[:, 30] = False  # x = 55
    assert room_without_pits(surface(has_floor)) == (40.0, 55.0, -26.0, -14.0)
    has_floor[4] = False  # y = -24
    assert room_without_pits(surface(has_floor)) == (40.0, 55.0, -23.0, -14.0)


def start(
    middle: tuple[float, float],
    *obstacles: Obstacle,
    floorless: float = 0.0,
    climb: float = 0.0,
    cell: float = 0.25,
) -> tuple[Start, list[str]]:
    """On a map of 20 x 16 m that climbs, without a floor within a radius of its middle."""
    y, x = np.mgrid[-8.0 : 8.0 + cell / 2 : cell, -10.0 : 10.0 + cell / 2 : cell]
    ground = Heightfield(climb * x, cell, middle)
    found = Surface(ground, np.zeros(0, bool), np.hypot(x, y) >= floorless)
    notes = list[str]()
    world = World("w", ground, obstacles, 0, None)
    return free_start(world, found, 0.1, notes), notes


def post(x: float, y: float, half: float = 0.5) -> Obstacle:
    return Obstacle(ObstacleKind.HAZARD, "cylinder", (half, 1.0), (x, y, 0.0))


@pytest.mark.parametrize(
    ("middle", "is_on_map"),
    [
        *(((0.0, 0.0), True), ((3.0, -4.0), True), ((100.0, 50.0), False)),
        *(((9.6, 0.0), False), ((0.0, 7.6), False)),  # less than half a metre from its edge
    ],
)
def test_a_rover_starts_at_the_origin_if_that_is_on_the_map_else_in_its_middle(
    middle: tuple[float, float], is_on_map: bool
) -> None:
    wanted = (0.0, 0.0) if is_on_map else middle
    assert start(middle) == ((*wanted, 0.0), [])
    kerb = Obstacle(ObstacleKind.ROCK, "cylinder", (0.5, 0.05), (*wanted, 0.0))
    assert start(middle, kerb) == ((*wanted, 0.0), [])
    beside, notes = start(middle, post(*wanted))
    assert np.hypot(*np.subtract(beside[:2], wanted)) == pytest.approx(1.2, abs=0.2)  # 0.5 m + 0.7 m
    said = f"starts at {beside[0]:g},{beside[1]:g}, the free and gentle place next to its middle"
    assert (beside[2], notes) == (0.0, [said])
    away, _ = start(middle, floorless=5.0)
    assert 5.3 < np.hypot(*np.subtract(away[:2], middle)) < 8.0  # to cells of 0.25 m
    coarse, _ = start(middle, post(*wanted), cell=2.0)  # looked at no finer than the heights are
    assert (np.subtract(coarse[:2], middle) % 2.0).tolist() == [1.0, 1.0]
    fine, _ = start(middle, floorless=1.0, cell=0.061)  # the map ends within a cell of 0.1 m
    off = max(1.7, np.hypot(*np.subtract(wanted, middle)))
    assert np.hypot(*np.subtract(fine[:2], middle)) == pytest.approx(off, abs=0.15)


def test_a_start_is_no_steeper_than_fifteen_degrees() -> None:
    assert start((0.0, 0.0), climb=np.tan(np.radians(14.9)))[0] == (0.0, 0.0, 0.0)
    with pytest.raises(
        UsageError, match=r"no place of 0\.7 m around that is free and no steeper than 15 deg"
    ):
        start((0.0, 0.0), climb=np.tan(np.radians(15.1)))
