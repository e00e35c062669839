"""Lines past obstacles, by complex numbers."""

import cmath

import pytest
from hypothesis import given
from hypothesis import strategies as st

from harness.drivers.approach import Line, line_past
from harness.world.obstacles import Obstacle, ObstacleKind

metres, angles = st.floats(-50.0, 50.0), st.floats(-10.0, 10.0)


@given(x=metres, y=metres, heading=angles, ahead=metres, left=metres)
def test_a_line_tells_how_far_ahead_and_how_far_to_its_left_a_point_lies(
    x: float, y: float, heading: float, ahead: float, left: float
) -> None:
    line, direction = Line((x, y), heading), cmath.rect(1.0, heading)
    point = complex(x, y) + complex(ahead, left) * direction
    there = point.real, point.imag
    assert (line.along(there), line.aside(there)) == pytest.approx((ahead, left), abs=1e-9)
    reached = complex(x, y) + ahead * direction
    assert line.at(ahead) == pytest.approx((reached.real, reached.imag), abs=1e-9)


@given(x=metres, y=metres, heading=angles, aside=metres)
def test_a_line_past_an_obstacle_has_it_so_far_to_its_right(
    x: float, y: float, heading: float, aside: float
) -> None:
    post = Obstacle(
        kind=ObstacleKind.HAZARD, shape="cylinder", half_size=(0.1, 1.0), position=(x, y, 5.0)
    )
    line = line_past(post, heading, aside)
    assert line.heading == heading
    assert (line.along((x, y)), line.aside((x, y))) == pytest.approx((0.0, -aside), abs=1e-9)
