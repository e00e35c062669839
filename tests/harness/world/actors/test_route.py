"""Where somebody on a route is: the closed form of the arc length along a polyline."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from harness.base.errors import UsageError
from harness.world.actors.route import Route, timed

CORNER = [(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
METRES = st.floats(-9, 9)


@settings(max_examples=60)
@given(
    st.lists(st.tuples(METRES, METRES, st.floats(-2, 2)), min_size=2, max_size=6),
    st.floats(0.1, 3.0),
    st.floats(0.0, 60.0),
    st.booleans(),
)
def test_the_distance_walked_is_the_arc_length_there_and_back_or_round(
    points: list[tuple[float, float, float]], speed: float, time_s: float, closed: bool
) -> None:
    """Against numpy's interpolation over the cumulative length, in three dimensions."""
    way = np.array([*points, points[0]] if closed else [*points, *points[-2::-1]])
    station = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(way, axis=0), axis=1))])
    assume(station[-1] > 1e-6)
    place = Route.at_speed(points, speed, closed=closed, delay=2.0).place(time_s)
    along = (max(0.0, time_s - 2.0) * speed) % station[-1]
    assume(min(along, station[-1] - along) > 1e-6)  # the seam of two rounds
    expected = [np.interp(along, station, way[:, axis]) for axis in (0, 1)]
    assert (place.x, place.y) == pytest.approx(expected, abs=1e-6)


def test_one_turns_into_the_next_leg_within_a_tenth_of_a_second() -> None:
    route, up = Route.at_speed(CORNER, 1.0), math.pi / 2
    times = (0.0, 1.0, 3.0, 3.05, 3.1, 3.5, 6.9, 7.5, 13.0, 13.9)
    expected = [0.0, 0.0, 0.0, up / 2, up, up, up, -up, math.pi, math.pi]
    assert [route.place(time_s).yaw for time_s in times] == pytest.approx(expected)


def test_who_has_one_point_stands_and_points_that_are_one_cost_no_time() -> None:
    stands = Route.at_speed([(1.0, 2.0), (1.0, 2.0)], 1.0).place(5.0)
    assert (stands.x, stands.y, stands.yaw) == (1.0, 2.0, 0.0)
    twice = [(0.0, 0.0), (0.0, 0.0), (3.0, 0.0), (3.0, 0.0), (3.0, 4.0)]
    assert Route.at_speed(twice, 1.0).times == Route.at_speed(CORNER, 1.0).times


def test_who_waits_looks_along_the_next_leg_that_leads_anywhere() -> None:
    a, b, down = (1.0, 2.0), (3.0, -1.0), math.atan2(-3.0, 2.0)
    for times, points, time_s, yaw in (
        ((0.0, 2.0, 3.0), [a, a, b], 1.0, down),
        ((0.0, 1.0, 5.0, 6.0), [(0.0, 0.0), (3.0, 0.0), (3.0, 0.0), (3.0, 4.0)], 3.0, math.pi / 2),
        ((0.0, 2.0, 3.0), [a, b, b], 9.0, down),  # again
    ):
        waits = timed(times, points, loops=False, delay=0.0, who="x")
        assert waits.place(time_s).yaw == pytest.approx(yaw)


def test_who_is_at_two_points_at_one_time_jumps() -> None:
    points = [(x, 2.0) for x in (0.0, 1.0, 5.0, 6.0, 9.0)]
    route = timed((0.0, 1.0, 1.0, 2.0, 2.0), points, loops=False, delay=0.0, who="x")
    assert [route.place(time_s).x for time_s in (0.5, 1.0, 1.5, 2.0, 7.0)] == [0.5, 5.0, 5.5, 9.0, 9.0]
    later = timed((2.0, 3.0, 3.0, 4.0, 4.0), points, loops=False, delay=1.5, who="x")
    assert [later.place(3.5 + t) for t in (0.0, 0.5, 1.5)] == [route.place(t) for t in (0.0, 0.5, 1.5)]


@pytest.mark.parametrize("times", [(0.0, 2.0, 1.0), (-0.1, 2.0, 3.0)])
def test_times_that_do_not_ascend_are_refused(times: tuple[float, ...]) -> None:
    with pytest.raises(UsageError, match="x: the times of its way points do not ascend from 0 on"):
        timed(times, CORNER, loops=True, delay=0.0, who="x")
