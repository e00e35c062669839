"""Which corners make a simple polygon, and distances to it, against closed forms."""

import math
from itertools import combinations, product

import numpy as np
import pytest

from rover_metrics.extended.polygon import Point, PolygonDistance, complaint

U_SHAPE = ((-1, -1), (1, -1), (1, 1), (0.5, 1), (0.5, 0), (-0.5, 0), (-0.5, 1), (-1, 1))
# The rectangles that it is made of: x_min, x_max, y_min, y_max.
PARTS = ((-1, 1, -1, 0), (-1, -0.5, -1, 1), (0.5, 1, -1, 1))


def to_u_shape(x: float, y: float) -> float:
    return min(math.hypot(max(x0 - x, 0, x - x1), max(y0 - y, 0, y - y1)) for x0, x1, y0, y1 in PARTS)


@pytest.mark.parametrize("corners", [U_SHAPE, U_SHAPE[::-1], U_SHAPE[3:] + U_SHAPE[:3]])
def test_distances_are_those_of_the_rectangles_it_is_made_of(corners: tuple[Point, ...]) -> None:
    """Also of points level with corners, on edges and in the notch, alone and several at once."""
    polygon = PolygonDistance(corners)
    places = list(product(np.arange(-16, 17) / 8, repeat=2))
    expected = [to_u_shape(*place) for place in places]
    for start in range(0, len(places), 33):
        x, y = np.array(places[start : start + 33]).T
        assert polygon(x, y) == pytest.approx(min(expected[start : start + 33]))
    for x, y in places[::7]:
        assert polygon(np.array([x]), np.array([y])) == pytest.approx(to_u_shape(x, y))


def cross(o: Point, a: Point, b: Point) -> float:
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])


def on(p: Point, a: Point, b: Point) -> bool:
    """Whether p is on the segment: it sees the ends in opposite directions, or is one of them."""
    dot = (a[0] - p[0]) * (b[0] - p[0]) + (a[1] - p[1]) * (b[1] - p[1])
    return cross(p, a, b) == 0 and dot <= 0


def meets(corners: tuple[Point, ...], i: int, j: int) -> bool:
    """Whether edges i < j share a point that they must not share."""
    n = len(corners)
    (a, b), (c, d) = ((corners[k], corners[(k + 1) % n]) for k in (i, j))
    if j == i + 1:
        return on(d, a, b) or on(a, c, d)
    if (j + 1) % n == i:
        return on(b, c, d) or on(c, a, b)
    if on(a, c, d) or on(b, c, d) or on(c, a, b) or on(d, a, b):
        return True
    straddle = (cross(a, b, c) > 0) != (cross(a, b, d) > 0)
    return straddle and (cross(c, d, a) > 0) != (cross(c, d, b) > 0)


def expected_complaint(corners: tuple[Point, ...]) -> str | None:
    n = len(corners)
    if any(corners[k] == corners[(k + 1) % n] for k in range(n)):
        return "has the same corner twice"
    pairs = [(i + 1, j + 1) for i, j in combinations(range(n), 2) if meets(corners, i, j)]
    if not pairs:
        return None
    return f"crosses or touches itself, with edges {pairs[0][0]} and {pairs[0][1]}"


@pytest.mark.parametrize("count", [3, 4, 5, 6])
def test_corners_on_a_lattice_are_refused_where_edges_meet(count: int) -> None:
    """All triples, and a thousand of each longer list, so that many touch or run along each other."""
    lattice: list[Point] = [(x, y) for x in (0.0, 1.0, 2.0) for y in (0.0, 1.0, 2.0)]
    rng = np.random.default_rng(count)
    drawn: list[tuple[Point, ...]] = (
        list(product(lattice, repeat=3))
        if count == 3
        else [tuple(lattice[k] for k in rng.integers(9, size=count)) for _ in range(1000)]
    )
    simple = 0
    for corners in drawn:
        assert complaint(corners) == expected_complaint(corners), corners
        simple += complaint(corners) is None
    assert simple > 3


@pytest.mark.parametrize(
    ("corners", "told"),
    [
        ([(0, 0), (1000, 0), (0, -1000)], None),
        ([(0, 0), (1000.001, 0), (0, 1)], "is not within 1000 m"),
        ([(0, 0), (1, 0), (0, -1000.001)], "is not within 1000 m"),
        ([(0, 0), (1, 0), (math.nan, 1)], "is not within 1000 m"),
        ([(0, 0), (1e-6, 0), (0, 1)], None),
        ([(0, 0), (0.9e-6, 0), (0, 1)], "the same corner twice"),
        ([(0, 0), (1, 0)], "has 2 corners, not 3 to 100"),
        ([(math.cos(i / 16), math.sin(i / 16)) for i in range(100)], None),
        ([(math.cos(i / 17), math.sin(i / 17)) for i in range(101)], "has 101 corners"),
    ],
)
def test_sizes_have_their_limits(corners: list[Point], told: str | None) -> None:
    found = complaint(corners)
    assert (found is None) if told is None else (found is not None and told in found)
