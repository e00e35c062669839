"""Distances from lidar returns to a rover's outline, and what an outline must be."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rover_metrics.errors import ParameterError
from rover_metrics.extended.footprint import Footprint, FootprintClearance, LidarPose

SQUARE = Footprint.rectangle((-0.2, 0.2, -0.2, 0.2))
LIDAR = LidarPose(0.174, 0.0, math.pi)  # of both rovers: it looks backwards

PLACES = st.floats(-2.0, 2.0)
READINGS = st.floats(0.0, 12.0, width=32) | st.sampled_from([math.inf, -math.inf, math.nan])


@st.composite
def stars(draw: st.DrawFn) -> Footprint:
    """A simple polygon: corners around a point at growing angles, rarely convex."""
    radii = draw(st.lists(st.floats(0.05, 1.5), min_size=3, max_size=9))
    corners = [
        (r * math.cos(math.tau * i / len(radii)), r * math.sin(math.tau * i / len(radii)))
        for i, r in enumerate(radii)
    ]
    return Footprint(tuple(corners[:: draw(st.sampled_from([1, -1]))]))


def clearance(footprint: Footprint, x: float, y: float) -> float:
    """Of one point, by the definition: 0 where the boundary winds around it."""
    corners = np.array(footprint.corners) - (x, y)
    following = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * following[:, 1] - corners[:, 1] * following[:, 0]
    turns = np.arctan2(cross, (corners * following).sum(axis=1)).sum() / math.tau
    if abs(round(turns)) == 1:
        return 0.0
    along = following - corners
    shares = np.clip(-(corners * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.linalg.norm(corners + shares[:, None] * along, axis=1).min())


@given(
    footprint=stars(),
    pose=st.builds(LidarPose, PLACES, PLACES, st.floats(-7.0, 7.0)),
    ranges=st.lists(READINGS, max_size=40),
)
def test_the_nearest_of_a_scan_is_of_its_returns(
    footprint: Footprint, pose: LidarPose, ranges: list[float]
) -> None:
    bearings = np.linspace(-3.0, 3.0, len(ranges))
    places = [
        (pose.x + r * math.cos(b + pose.yaw), pose.y + r * math.sin(b + pose.yaw))
        for r, b in zip(ranges, bearings, strict=True)
        if math.isfinite(r)
    ]
    expected = min((clearance(footprint, *place) for place in places), default=math.inf)
    found = FootprintClearance(footprint, pose, bearings).nearest(ranges)
    assert found == pytest.approx(expected, abs=1e-9)


def test_near_returns_are_contacts_only_if_they_shall_be() -> None:
    bearings, ranges = [0.0, 1.0], [-math.inf, 5.0]
    assert FootprintClearance(SQUARE, LIDAR, bearings).nearest(ranges) > 4.0
    strict = FootprintClearance(SQUARE, LIDAR, bearings, near_returns_are_contacts=True)
    assert strict.nearest(ranges) == 0.0
    assert min(strict.nearest([no, 5.0]) for no in (math.nan, math.inf)) > 4.0


def test_ranges_that_do_not_fit_the_bearings_are_refused() -> None:
    with pytest.raises(ValueError, match="3 ranges do not fit 2 bearings"):
        FootprintClearance(SQUARE, LIDAR, [0.0, 1.0]).nearest([1.0, 1.0, 1.0])


def test_what_is_no_simple_polygon_is_refused_in_one_line() -> None:
    for numbers, complaint in (
        ([], "^footprint has 0 corners"),
        ([0, 0, 1, 0, 1], "has 5 numbers, so one corner lacks its y"),
        ([0, 0, 1, 1, 1, 0, 0, 1], "with edges 1 and 3"),  # a bow tie
    ):
        with pytest.raises(ParameterError, match=complaint):
            Footprint.from_flat(numbers)


def test_numbers_are_taken_in_their_order() -> None:
    corners = ((1.0, 2.0), (3.0, 4.0), (5.0, 7.0))
    assert Footprint.from_flat([1, 2, 3, 4, 5, 7]).corners == corners
    assert Footprint.rectangle((1, 3, 5, 8)).corners == ((1, 5), (3, 5), (3, 8), (1, 8))
    assert LidarPose.from_flat([1, 2, 3]) == LidarPose(x=1.0, y=2.0, yaw=3.0)
    assert LidarPose() == LidarPose(0.0, 0.0, 0.0)


@pytest.mark.parametrize("numbers", [[], [1, 2], [1, 2, 3, 4], [0, 0, math.inf], [math.nan, 0, 0]])
def test_a_lidar_pose_is_three_finite_numbers(numbers: list[float]) -> None:
    with pytest.raises(ParameterError, match=r"lidar_pose .* x and y in metres, yaw in radians"):
        LidarPose.from_flat(numbers)


def test_ranges_are_taken_as_a_message_carries_them() -> None:
    """As float32, also where a simulator measures in float64."""
    distances = FootprintClearance(SQUARE, LidarPose(), [0.0])
    assert distances.nearest([1.1]) == distances.nearest(np.array([1.1], np.float32)) != 1.1 - 0.2


def test_one_return_is_as_far_as_its_point_at_any_range() -> None:
    for bearing in np.linspace(-3.0, 3.0, 61):
        far = FootprintClearance(SQUARE, LidarPose(0.17, 0.0, math.pi), [bearing])
        assert far.nearest([1e30]) == pytest.approx(1e30, rel=1e-6)  # as a broken sensor tells
