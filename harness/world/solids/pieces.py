"""Solids that no heightfield shows -> convex obstacles: MuJoCo collides a mesh as its convex hull.

What hangs together is one body. A body is halved, and its halves again, until each part is as its convex
hull, to within FIT: either nearly all of the hull's surface is its own (a box, a piece of a pipe), or it
is nearly flat, and becomes a slab THICKNESS deep on its inner side. It is halved across, or by the
directions that its triangles face, whichever gives fewer parts. A vaulted ceiling of a structure (what
faces down, HEADROOM above the ground) is touched by nobody: it stays as it is, to be seen.

A body on which a rover can stand (STANDING_AREA no steeper than STEEPEST) is a structure, as a bridge:
its gentle triangles are deck, which is ground; others are rocks where they are no higher than the rover
clears, else hazards. Other bodies are rocks or hazards by the height of their top above the ground.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from itertools import islice

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError, unknown
from harness.spec.world import WorldSpec
from harness.world.heightfield import Field, Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, convex, outline, surface, top
from harness.world.occupancy import HEADROOM
from harness.world.solid import Primitive, Solid
from harness.world.solids.mesh_file import SIMPLER, Mesh, areas_and_normals
from harness.world.solids.surface import SAMPLES, on_map

THICKNESS = 0.02  # [m]
STANDING_AREA = 1.0  # [m2]
STEEPEST = math.radians(35.0)
SMALLEST_AREA = 1e-6  # [m2] of a triangle
FIT = 0.03  # [m] by which a piece may differ from its triangles
OWN_SHARE = 0.8  # of the surface of a hull
FILLED_SHARE = 0.9  # of the area of an outline
CUTS = 65  # places where a body may be halved
FLAT_SHARE = 0.95  # of the area of triangles that is left when they are seen along their mean normal
FEWEST = 6  # triangles that can have a hull of their own
FLUSH = 0.005  # [m] above the ground up to which a body counts as buried
MOST_PIECES = 6000

ALIKE = 0.02  # difference of unit normals
DOWNWARD = 0.1  # downward part of the normal of a ceiling

Points = NDArray[np.float64]  # shape (n, 3) [m]
Halves = Callable[[Mesh, Points], NDArray[np.bool_]]  # a part and its normals -> which are one half


Kind = Callable[[float], ObstacleKind]  # of what is that high above the ground [m]


class Kinds:
    """The rule of one world; a pattern that fits no solid is a UsageError.

    Args:
        spec: With the height and the names that override the rover's clearance.
        clearance: Height of obstacles that the rover drives over [m].
        names: Of all solids: model::link::collision.

    Attributes:
        limit: Height above the ground up to which an obstacle is a rock [m].
    """

    def __init__(self, spec: WorldSpec, clearance: float, names: Sequence[str]) -> None:
        self.clearance = clearance
        self.limit = clearance if spec.rock_height is None else spec.rock_height
        self._named = {ObstacleKind.HAZARD: spec.hazard, ObstacleKind.ROCK: spec.rock}
        models = dict.fromkeys(name.split("::")[0] for name in names)
        for flag, patterns in (("--hazard", spec.hazard), ("--rock", spec.rock)):
            for pattern in patterns:
                if not any(_fits(name, pattern) for name in names):
                    raise UsageError(f"{flag}: {unknown('solid', pattern, [*models][:12])}")

    def by_height(self, height: float) -> ObstacleKind:
        """Returns the kind of an obstacle by its height above the ground [m]."""
        return ObstacleKind.ROCK if height <= self.limit else ObstacleKind.HAZARD

    def of(self, name: str) -> Kind:
        """Returns the rule for a solid of that name."""
        for kind, patterns in self._named.items():
            if any(_fits(name, pattern) for pattern in patterns):
                return lambda _, kind=kind: kind  # type: ignore[misc]  # bound now
        return self.by_height


def _fits(name: str, pattern: str) -> bool:
    """Whether a pattern fits the whole name, or that of the model."""
    return fnmatchcase(name, pattern) or fnmatchcase(name.split("::", maxsplit=1)[0], pattern)


def bodies(mesh: Mesh) -> Iterator[Mesh]:
    """Yields the parts of a mesh that hang together."""
    if not len(mesh.faces):
        return
    starts, ends = mesh.faces[:, :2].ravel(), mesh.faces[:, 1:].ravel()
    count = len(mesh.vertices)
    links = coo_matrix((np.ones(starts.size), (starts, ends)), (count, count))
    body = connected_components(links, directed=False)[1][mesh.faces[:, 0]]
    order = np.argsort(body, kind="stable")
    for chosen in np.split(order, np.flatnonzero(np.diff(body[order])) + 1):
        yield mesh.part(chosen)


def obstacles_of(mesh: Mesh, ground: Heightfield, kind: Kind, clearance: float) -> list[Obstacle]:
    """Returns a mesh as convex obstacles, without bodies in the ground or off the map, unless too many.

    Args:
        mesh: What the ground does not show, in the world.
        ground: On which it stands.
        kind: What an obstacle is, by the height of its top above the ground.
        clearance: What the rover clears [m].
    """
    pieces: list[Obstacle] = []
    for body in bodies(mesh):
        rises = _rise(body.vertices, ground)
        if rises > FLUSH:
            pieces += _pieces(body, kind(rises), clearance, ground)
        if len(pieces) > MOST_PIECES:
            raise UsageError(
                f"what stands on its ground has more than {MOST_PIECES} facets; {SIMPLER}, or give "
                "boxes for collisions"
            )
    return pieces


def _rise(points: NDArray[np.float64], ground: Heightfield) -> float:
    """How far points reach above the ground [m]; -inf if all are off the map."""
    x, y, z = points[on_map(points, ground)].T
    return float((z - ground.heights_at(x, y)).max(initial=-math.inf))


def _pieces(body: Mesh, kind: ObstacleKind, clearance: float, ground: Heightfield) -> Iterator[Obstacle]:
    areas, normals = areas_and_normals(body.corners)
    is_gentle = normals[:, 2] >= math.cos(STEEPEST)
    is_structure = areas[is_gentle].sum() >= STANDING_AREA
    whole = _own_hull(body, areas)
    if whole is not None:  # a structure only if it is a slab: nobody gets onto a block
        is_slab = is_structure and np.ptp(body.vertices[:, 2]) <= clearance
        yield convex(ObstacleKind.DECK if is_slab else kind, whole)
        return
    kinds = np.full(len(areas), kind.value)
    if is_structure:
        is_low = np.ptp(body.corners[:, :, 2], axis=1) <= clearance
        kinds = np.where(is_low, ObstacleKind.ROCK.value, ObstacleKind.HAZARD.value)
        kinds[is_gentle] = ObstacleKind.DECK.value
    chosen = areas > SMALLEST_AREA
    is_ceiling = chosen & _is_ceiling(body, normals, ground)
    ceiling = body.part(is_ceiling)
    if (
        is_structure
        and len(ceiling.faces) >= FEWEST
        and _slab(ceiling, areas[is_ceiling], normals[is_ceiling]) is None
    ):
        yield surface(ObstacleKind.DECK, ceiling.vertices, ceiling.faces)
        chosen &= ~is_ceiling
    for value in np.unique(kinds[chosen]).tolist():
        alike = np.flatnonzero(chosen & (kinds == value))
        across = [*_split(body, alike, areas, normals, _across)]
        facing = [*islice(_split(body, alike, areas, normals, _by_facing), len(across))]
        yield from (convex(ObstacleKind(value), corners) for corners in min(across, facing, key=len))


def _is_ceiling(body: Mesh, normals: Points, ground: Heightfield) -> NDArray[np.bool_]:
    x, y, z = np.moveaxis(SAMPLES @ body.corners, -1, 0)
    is_high = (z > ground.heights_at(x, y) + HEADROOM).all(axis=1)
    return np.asarray(is_high & (normals[:, 2] < -DOWNWARD))


def _split(
    body: Mesh, chosen: NDArray[np.int64], areas: Field, normals: Points, halves: Halves
) -> Iterator[Points]:
    """Corners of convex pieces that are chosen triangles of a body; areas and normals are of all."""
    part = body.part(chosen)
    corners = _own_hull(part, areas[chosen])
    if corners is None:
        corners = _slab(part, areas[chosen], normals[chosen])
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


def _own_hull(part: Mesh, areas: Field) -> Points | None:
    """Corners of its hull, if nearly all of the hull's surface is its own and it has no hollow."""
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


def _slab(part: Mesh, areas: Field, normals: Points) -> Points | None:
    """Corners of a slab, if it is nearly flat and fills its outline; a triangle always is and does."""
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


def obstacle_of(solid: Solid, ground: Heightfield, kind: Kind) -> Obstacle | None:
    """Returns a primitive as an obstacle; None if it lies in the ground or off the map.

    Args:
        solid: Whose shape is a Primitive.
        ground: On which it stands.
        kind: What an obstacle is whose top is that high above the lowest ground below it [m].
    """
    assert isinstance(solid.shape, Primitive)  # noqa: S101 - the caller has looked
    x, y, z, w = Rotation.from_matrix(solid.pose[:3, :3]).as_quat(canonical=True).tolist()
    position = tuple(solid.pose[:3, 3].tolist())
    obstacle = Obstacle(
        ObstacleKind.HAZARD,
        solid.shape.shape,
        solid.shape.half_size,
        position,
        (w, x, y, z),
        color=solid.color,
    )
    below = np.vstack([outline(obstacle), position[:2]])
    below = below[on_map(below, ground)]
    if not len(below):
        return None
    height = top(obstacle) - float(ground.heights_at(*below.T).min())
    return replace(obstacle, kind=kind(height)) if height > FLUSH else None
