"""Where somebody on a route is: the closed form of the arc length along a polyline."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from harness.base.errors import UsageError
from harness.world.actors.route import Route, timed

CORNER = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)]


def test_there_and_back_at_two_metres_a_second() -> None:
    route, up = Route.at_speed(CORNER, 2.0), math.pi / 2
    found = [route.place(time_s) for time_s in (0.0, 1.0, 2.5, 3.5, 4.5, 6.0, 7.0, 7.5, 700.5)]
    assert [one.x for one in found] == pytest.approx([0, 2, 3, 3, 3, 2, 0, 1, 1])
    assert [one.y for one in found] == pytest.approx([0, 0, 2, 4, 2, 0, 0, 0, 0])
    assert [abs(one.yaw) for one in found] == pytest.approx([0, 0, up, up, up, math.pi, math.pi, 0, 0])
    assert found[4].yaw < 0.0 < found[3].yaw


@settings(max_examples=40)
@given(
    st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9), st.floats(-2, 2)), min_size=2, max_size=6),
    st.floats(0.1, 3.0),
    st.floats(0.0, 60.0),
    st.booleans(),
)
def test_the_way_walked_is_the_arc_length(
    points: list[tuple[float, float, float]], speed: float, time_s: float, closed: bool
) -> None:
    """Against numpy's interpolation over the cumulative length, in three dimensions."""
    way = np.array([*points, points[0]] if closed else [*points, *points[-2::-1]])
    station = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    found = Route.at_speed(points, speed, closed=closed, delay=2.0).place(time_s)
    if station[-1] < 1e-6:
        return
    along = (max(0.0, time_s - 2.0) * speed) % station[-1]
    if min(along, station[-1] - along) < 1e-6:
        return  # at the seam of two rounds
    expected = [np.interp(along, station, way[:, axis]) for axis in (0, 1)]
    assert (found.x, found.y) == pytest.approx(expected, abs=1e-6)


def test_one_turns_into_the_next_leg_within_a_tenth_of_a_second() -> None:
    route = Route.at_speed(CORNER, 1.0)
    yaws = [route.place(3.0 + part).yaw for part in (0.0, 0.05, 0.1, 0.5)]
    assert yaws == pytest.approx([0.0, math.pi / 4, math.pi / 2, math.pi / 2])


def test_who_has_one_point_stands_and_points_that_are_one_cost_no_time() -> None:
    stands = Route.at_speed([(1.0, 2.0), (1.0, 2.0)], 1.0).place(5.0)
    assert (stands.x, stands.y, stands.yaw) == (1.0, 2.0, 0.0)
    twice = [(0.0, 0.0), (0.0, 0.0), (3.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    assert Route.at_speed(twice, 1.0).times == Route.at_speed(CORNER, 1.0).times
    climbs = Route.at_speed([(0.0, 0.0, 0.0), (0.0, 0.0, 5.0), (3.0, 0.0, 5.0)], 1.0)
    assert [climbs.place(time_s).x for time_s in (4.0, 6.0)] == [0.0, 1.0]


@pytest.mark.parametrize(
    ("loops", "time_s", "x"),
    [(True, 3.0, 0.5), (True, 9.0, 2.0), (True, 13.0, 0.5), (False, 13.0, 3.0), (False, 1.0, 0.0)],
)
def test_a_script_is_walked_at_its_own_times(loops: bool, time_s: float, x: float) -> None:
    """It begins after the delay and its first time, waits from 4 s to 7 s of itself, ends at 10 s."""
    times = (1.0, 3.0, 5.0, 8.0, 11.0)
    points = [(at, 0.0) for at in (0.0, 1.0, 2.0, 2.0, 3.0)]
    route = timed(times, points, loops=loops, delay=1.0, who="x")
    assert route.place(time_s).x == pytest.approx(x)
    waits = route.place(7.5)
    assert (waits.x, waits.yaw) == (2.0, 0.0)


@pytest.mark.parametrize(
    ("times", "points", "time_s", "yaw"),
    [
        ((0.0, 2.0, 3.0), [(1.0, 2.0), (1.0, 2.0), (3.0, -1.0)], 1.0, math.atan2(-3.0, 2.0)),
        ((0.0, 1.0, 5.0, 6.0), [(0.0, 0.0), (3.0, 0.0), (3.0, 0.0), (3.0, 4.0)], 3.0, math.pi / 2),
        ((0.0, 2.0, 3.0), [(1.0, 2.0), (3.0, -1.0), (3.0, -1.0)], 9.0, math.atan2(-3.0, 2.0)),  # again
    ],
)
def test_who_waits_looks_along_the_next_leg_that_leads_anywhere(
    times: tuple[float, ...], points: list[tuple[float, float]], time_s: float, yaw: float
) -> None:
    waits = timed(times, points, loops=False, delay=0.0, who="x")
    assert waits.place(time_s).yaw == pytest.approx(yaw)


@pytest.mark.parametrize(("time_s", "x"), [(0.5, 0.5), (1.0, 5.0), (1.5, 5.5), (2.0, 9.0), (7.0, 9.0)])
def test_who_is_at_two_points_at_one_time_jumps(time_s: float, x: float) -> None:
    points = [(x, 2.0) for x in (0.0, 1.0, 5.0, 6.0, 9.0)]
    route = timed((0.0, 1.0, 1.0, 2.0, 2.0), points, loops=False, delay=0.0, who="x")
    assert (route.place(time_s).x, route.place(time_s).y) == (x, 2.0)


def test_a_route_begins_anew_unless_it_is_told_otherwise() -> None:
    assert Route((0.0, 1.0), ((0.0, 0.0), (1.0, 0.0))).place(1.5).x == pytest.approx(0.5)


@pytest.mark.parametrize("times", [(0.0, 2.0, 1.0), (-0.1, 2.0, 3.0)])
def test_times_that_do_not_ascend_are_refused(times: tuple[float, ...]) -> None:
    with pytest.raises(UsageError, match="x: the times of its way points do not ascend from 0 on"):
        timed(times, CORNER, loops=True, delay=0.0, who="x")
