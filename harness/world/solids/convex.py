"""Triangles -> convex pieces.

A body is halved, and its halves again, until each part is as its convex hull, to within FIT: either
nearly all of the hull's surface is its own (a box, a piece of a pipe), or it is nearly flat, and becomes
a slab THICKNESS deep on its inner side. It is halved across, or by the directions that its triangles
face, whichever gives fewer parts.
"""

from collections.abc import Callable, Iterator
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from harness.base.mesh import Mesh
from harness.world.heightfield import Field

THICKNESS = 0.02  # [m]
FIT = 0.03  # [m] by which a piece may differ from its triangles
OWN_SHARE = 0.8  # of the surface of a hull
FILLED_SHARE = 0.9  # of the area of an outline
CUTS = 65  # places where a body may be halved
FLAT_SHARE = 0.95  # of the area of triangles that is left when they are seen along their mean normal
FEWEST = 6  # triangles that can have a hull of their own
ALIKE = 0.02  # difference of unit normals
Points = NDArray[np.float64]  # shape (n, 3) [m]
Halves = Callable[[Mesh, Points], NDArray[np.bool_]]  # a part and its normals -> which are one half


def convex_pieces(body: Mesh, chosen: NDArray[np.int64], areas: Field, normals: Points) -> list[Points]:
    """Returns the corners of each of the convex pieces that some triangles of a body are.

    Args:
        body: The body.
        chosen: Indices of the triangles.
        areas: Of all triangles of the body [m^2].
        normals: Of all triangles, shape (n, 3).
    """
    across = [*_split(body, chosen, areas, normals, _across)]
    facing = [*islice(_split(body, chosen, areas, normals, _by_facing), len(across))]
    return min(across, facing, key=len)


def _split(
    body: Mesh, chosen: NDArray[np.int64], areas: Field, normals: Points, halves: Halves
) -> Iterator[Points]:
    part = body.part(chosen)
    corners = own_hull(part, areas[chosen])
    if corners is None:
        corners = slab(part, areas[chosen], normals[chosen])
    if corners is not None:
        yield corners
        return
    is_first = halves(part, normals[chosen])
    if is_first.all() or not is_first.any():
        is_first = np.arange(len(chosen)) < len(chosen) // 2
    yield from _split(body, chosen[is_first], areas, normals, halves)
    yield from _split(body, chosen[~is_first], areas, normals, halves)


def _across(part: Mesh, _: Points) -> NDArray[np.bool_]:
    """Which triangles lie on one side of the plane across, near the middle, that cuts them least."""
    middles = part.corners.mean(axis=1)
    along = _longest(middles)
    ends, places = part.corners @ along, middles @ along
    low, high = ends.min(axis=1), ends.max(axis=1)
    inner = np.unique(np.quantile(ends, np.linspace(0.25, 0.75, CUTS), method="nearest"))
    cut_into = np.minimum(inner[:, None] - low, high - inner[:, None]).clip(0.0).sum(axis=1)
    return np.asarray(places < inner[np.argmin(cut_into)])


def _by_facing(part: Mesh, normals: Points) -> NDArray[np.bool_]:
    """Which triangles face one way, of those that differ most; across where all face alike."""
    places = normals @ _longest(normals)
    order = np.sort(places)
    gaps = np.diff(order) * np.sqrt(
        np.minimum(np.arange(1, len(order)), np.arange(len(order) - 1, 0, -1))
    )
    widest = int(np.argmax(gaps))
    if order[widest + 1] - order[widest] < ALIKE:
        return _across(part, normals)
    return np.asarray(places <= order[widest])


def _longest(points: Points) -> Points:
    """The direction in which points are spread most, shape (3,)."""
    return np.asarray(np.linalg.svd(points - points.mean(axis=0), full_matrices=False)[2][0])


def own_hull(part: Mesh, areas: Field) -> Points | None:
    """Returns the corners of a hull, if nearly all of it is the part's own surface, without hollows."""
    if len(part.faces) < FEWEST:
        return None
    try:
        hull = ConvexHull(part.vertices)
    except QhullError:  # flat
        return None
    depths = -(part.vertices @ hull.equations[:, :3].T + hull.equations[:, 3]).max(axis=1)
    if areas.sum() < OWN_SHARE * hull.area or depths.max() > FIT:
        return None
    return np.asarray(part.vertices[hull.vertices])


def slab(part: Mesh, areas: Field, normals: Points) -> Points | None:
    """Returns the corners of a slab, if a part is nearly flat and fills its outline, as any triangle."""
    mean = (areas[:, None] * normals).sum(axis=0)
    length = float(np.linalg.norm(mean))
    if length < FLAT_SHARE * areas.sum():
        return None
    normal = mean / length
    if np.ptp(part.vertices @ normal) > FIT:
        return None
    corners = part.vertices
    if len(part.faces) > 1:
        across = np.linalg.svd(normal[None])[2][1:]  # two axes at right angles to it
        try:
            outline = ConvexHull(corners @ across.T)
        except QhullError:
            return None
        if length < FILLED_SHARE * outline.volume:  # of two dimensions: its area
            return None
        corners = corners[outline.vertices]
    return np.concatenate([corners, corners - THICKNESS * normal])
