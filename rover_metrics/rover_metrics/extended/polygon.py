"""Simple polygons in the plane: whether corners make one, and how far points are from it."""

import math
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

MOST_CORNERS = 100
FARTHEST = 1000.0  # m
SHORTEST_EDGE = 1e-6  # m

Floats = NDArray[np.float64]
Point = tuple[float, float]
Edge = tuple[Point, Point]


class PolygonDistance:
    """Exact distances to a simple polygon, 0 inside; its corners are given in order [m]."""

    def __init__(self, corners: Sequence[Point]) -> None:
        edges = np.array(_edges(corners))
        self._x, self._y = edges[:, 0].T.copy()  # where the edges start, each shape (e,)
        self._dx, self._dy = (edges[:, 1] - edges[:, 0]).T.copy()
        squares = self._dx**2 + self._dy**2
        self._ux, self._uy = self._dx / squares, self._dy / squares
        self._end_y = edges[:, 1, 1].copy()

    def __call__(self, x: Floats, y: Floats) -> float:
        """Returns the smallest distance of some points [m], each shape (k,), k > 0."""
        px, py = x[:, None] - self._x, y[:, None] - self._y
        shares = (px * self._ux + py * self._uy).clip(0.0, 1.0)
        off_x, off_y = px - shares * self._dx, py - shares * self._dy
        squares = off_x * off_x + off_y * off_y
        # A ray from a point along x meets an edge that goes up on its right, or down on its left.
        # Heights are compared as they are: a difference may round to the other side of a corner.
        spans = (y[:, None] < self._y) != (y[:, None] < self._end_y)
        crossed = spans & ((self._dx * py > self._dy * px) == (self._dy > 0.0))
        if (np.count_nonzero(crossed, axis=1) & 1).any():
            return 0.0
        return math.sqrt(squares.min())


def complaint(corners: Sequence[Point]) -> str | None:
    """Tells what keeps corners from being a simple polygon; None if nothing does."""
    count = len(corners)
    if not 3 <= count <= MOST_CORNERS:
        return f"has {count} corners, not 3 to {MOST_CORNERS}"
    if not all(abs(value) <= FARTHEST for corner in corners for value in corner):
        return f"has a corner that is not within {FARTHEST:g} m"
    if any(math.dist(*edge) < SHORTEST_EDGE for edge in _edges(corners)):
        return "has the same corner twice"
    edges = enumerate(_edges(corners), start=1)
    for (i, first), (j, second) in combinations(edges, 2):
        joint = second[0] if j - i == 1 else first[0] if j - i == count - 1 else None
        if _meet(first, second, joint):
            return f"crosses or touches itself, with edges {i} and {j}"
    return None


def _edges(corners: Sequence[Point]) -> list[Edge]:
    return list(zip(corners, (*corners[1:], corners[0]), strict=True))


def _meet(first: Edge, second: Edge, joint: Point | None) -> bool:
    """Whether two edges have a point in common besides the corner that joins them."""
    (a, b), (c, d) = first, second
    triples = ((a, b, c), (a, b, d), (c, d, a), (c, d, b))
    sides = [side_of(*triple) for triple in triples]
    if sides[0] * sides[1] < 0.0 and sides[2] * sides[3] < 0.0:
        return True
    return any(
        side == 0.0 and triple[2] != joint and _within(*triple)
        for side, triple in zip(sides, triples, strict=True)
    )


def side_of(a: Point, b: Point, c: Point) -> float:
    """Returns a number that is positive if c is left of the line from a to b, and 0 if it is on it."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _within(a: Point, b: Point, c: Point) -> bool:
    """Whether c, which is on the line through a and b, is between them."""
    return min(a[0], b[0]) <= c[0] <= max(a[0], b[0]) and min(a[1], b[1]) <= c[1] <= max(a[1], b[1])
