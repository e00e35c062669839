"""Triangles that no heightfield shows -> convex obstacles: MuJoCo collides a mesh as its convex hull.

What hangs together is one body. A closed convex body is one obstacle; of another one each flat convex
facet becomes a prism, THICKNESS deep on its inner side, so that its outer side is where the mesh has it.

A body on which a rover can stand (STANDING_AREA no steeper than STEEPEST) is a structure, as a bridge is: its
gentle facets are deck, which is ground; its others are rocks where they are no higher than the rover clears,
else hazards. Of other bodies the height of their top above the ground decides, as of every obstacle.
"""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from harness.errors import UsageError
from harness.world.heightfield import Heightfield
from harness.world.obstacles import Obstacle, ObstacleKind, convex
from harness.world.solids.kinds import Kind
from harness.world.solids.mesh_file import SIMPLER, Mesh
from harness.world.solids.surface import on_map, slopes_up

THICKNESS = 0.02  # [m]
STANDING_AREA = 1.0  # [m2]
STEEPEST = math.radians(35.0)
SMALLEST_FACET = 1e-6  # [m2]
FLUSH = 0.005  # [m] above the ground up to which a body counts as buried
MOST_PIECES = 6000
CONVEX_SHARE = 0.999  # of its hull's area that a facet must have to be one piece


def bodies(mesh: Mesh) -> Iterator[Mesh]:
    """Yields the parts of a mesh that hang together."""
    from scipy.sparse import coo_matrix  # noqa: PLC0415 - 0.1 s that named terrains save
    from scipy.sparse.csgraph import connected_components  # noqa: PLC0415

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
    """Returns a mesh as convex obstacles; nothing of bodies that lie in the ground or off the map.

    Args:
        mesh: What the ground does not show, in the world.
        ground: On which it stands.
        kind: What an obstacle is, by the height of its top above the ground.
        clearance: What the rover clears [m].

    Raises:
        UsageError: They are too many.
    """
    found: list[Obstacle] = []
    for body in bodies(mesh):
        rises = _rise(body.vertices, ground)
        if rises > FLUSH:
            found += _pieces(body, kind(rises), clearance)
        if len(found) > MOST_PIECES:
            raise UsageError(
                f"what stands on its ground has more than {MOST_PIECES} facets; {SIMPLER}, or give boxes "
                "for collisions"
            )
    return found


def _rise(points: NDArray[np.float64], ground: Heightfield) -> float:
    """How far points reach above the ground [m]; -inf if all are off the map."""
    x, y, z = points[on_map(points, ground)].T
    return float((z - ground.heights_at(x, y)).max(initial=-math.inf))


def _pieces(body: Mesh, kind: ObstacleKind, clearance: float) -> Iterator[Obstacle]:
    import trimesh  # noqa: PLC0415 - loaded with the mesh; other terrains save it

    shape = trimesh.Trimesh(body.vertices, body.faces, process=False)
    is_gentle = np.asarray(slopes_up(body.corners) >= math.cos(STEEPEST))
    is_structure = shape.area_faces[is_gentle].sum() >= STANDING_AREA
    if shape.is_volume and shape.is_convex:
        is_slab = is_structure and np.ptp(body.vertices[:, 2]) <= clearance
        yield convex(ObstacleKind.DECK if is_slab else kind, body.vertices)
        return
    for facet in _facets(shape):
        corners = body.vertices[np.unique(body.faces[facet])]
        if is_structure:
            is_low = np.ptp(corners[:, 2]) <= clearance
            kind = ObstacleKind.ROCK if is_low else ObstacleKind.HAZARD
            kind = ObstacleKind.DECK if is_gentle[facet[0]] else kind
        inward = -THICKNESS * shape.face_normals[facet[0]]
        yield convex(kind, np.concatenate([corners, corners + inward]))


def _facets(shape: "object") -> Iterator[NDArray[np.int64]]:
    """Faces that make one flat convex piece, together or alone."""
    from scipy.spatial import ConvexHull, QhullError  # noqa: PLC0415 - as above

    single = shape.area_faces > SMALLEST_FACET
    for facet, area, normal in zip(shape.facets, shape.facets_area, shape.facets_normal, strict=True):
        corners = shape.vertices[np.unique(shape.faces[facet])]
        across = np.linalg.svd(normal[None])[2][1:]  # two axes at right angles to it
        try:
            hull = ConvexHull(corners @ across.T).volume  # of two dimensions: the area
        except QhullError:
            continue
        if area >= CONVEX_SHARE * hull:
            single[facet] = False
            yield np.asarray(facet)
    yield from np.flatnonzero(single)[:, None]
