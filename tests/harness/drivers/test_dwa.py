"""The dynamic window approach: what it does where it cannot go on, and what its places cost."""

from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.sparse import lil_array
from scipy.sparse.csgraph import shortest_path

from harness.drivers.base import Observation
from harness.drivers.base_local_planner import MOVED, OF_PATH, Turns, path_from, place_costs
from harness.drivers.dwa import Dwa
from harness.drivers.local_map import CELL, SIDE, LocalMap, MapOptions
from tests.harness.drivers.jackal import Pose, context, drives, lidar

ROOM = 0.35  # [m] beside the middle of a lane: too little to turn


def lane(pose: Pose, end: float) -> NDArray[np.float32]:
    """Ranges to the walls y = +-ROOM and x = end of a lane that is open behind."""
    x, y, angles = lidar(pose)
    with np.errstate(divide="ignore", invalid="ignore"):
        walls = [(end - x) / np.cos(angles), (ROOM - y) / np.sin(angles), (-ROOM - y) / np.sin(angles)]
    ahead = np.array([np.where(wall > 0.0, wall, np.inf) for wall in walls])
    return np.asarray(ahead.min(axis=0), np.float32)


def test_at_the_end_of_a_lane_it_backs_up_and_touches_nothing() -> None:
    driver = Dwa(context())
    driver.head_for(-4.0, 0.0, 0.0)
    poses = np.array([pose for pose, _ in drives(driver, partial(lane, end=0.5), 40)])
    assert np.abs(poses[:, 1:]).max(axis=0) == pytest.approx([0.0, 0.0], abs=0.02)
    assert poses[-1, 0] < -0.1


def test_who_has_turned_back_turns_only_on_until_it_has_moved() -> None:
    turns, here, rates = Turns(), (1.0, 2.0), np.array([-1.0, 1.0])
    turns.take(here, -0.4)
    assert turns.allowed(here, rates).tolist() == [True, True]
    turns.take(here, 0.4)
    assert turns.allowed(here, rates).tolist() == [False, True]
    assert turns.allowed((1.0 + 2 * MOVED, 2.0), rates).tolist() == [True, True]


@pytest.fixture
def walled() -> LocalMap:
    """A map of a lane's end 1.5 m ahead, that leads back to a goal behind it."""
    known = LocalMap(context(), MapOptions())
    known.see(Observation(0, 0.0, 0.0, 0.0, ranges=lane((0.0, 0.0, 0.0), 1.5)))
    known.plan((0.0, 0.0), (3.0, 0.0))
    return known


def test_places_cost_their_ways_along_rows_and_columns(walled: LocalMap) -> None:
    here, inscribed = walled.cell((0.0, 0.0)), 0.27
    path = path_from(walled.to_go, here)
    found = place_costs(walled, here, inscribed)
    free = walled.clearance > inscribed
    reach = int(inscribed / CELL)
    free[here[0] - reach : here[0] + reach + 1, here[1] - reach : here[1] + reach + 1] = True
    graph, flat = lil_array((SIDE * SIDE, SIDE * SIDE)), np.arange(SIDE * SIDE).reshape(SIDE, SIDE)
    for one, other, both in (
        (flat[1:], flat[:-1], free[1:] & free[:-1]),
        (flat[:, 1:], flat[:, :-1], free[:, 1:] & free[:, :-1]),
    ):
        graph[one[both], other[both]] = 1.0
    own = flat[tuple(path.T)]
    rows = shortest_path(graph.tocsr(), directed=False, unweighted=True, indices=own)
    lengths = rows.reshape(len(path), SIDE, SIDE)
    expected = CELL * (OF_PATH * lengths.min(axis=0) + lengths[-1])
    assert np.allclose(found[free], expected[free])
    assert np.isinf(found[~free]).all()


def test_its_path_descends_to_where_the_map_ends(walled: LocalMap) -> None:
    path = path_from(walled.to_go, walled.cell((0.0, 0.0)))
    left = walled.to_go[tuple(path.T)]
    assert (np.diff(left) < 0.0).all()
    assert left[-1] <= walled.to_go.min() + 2 * CELL
