"""Solids that no heightfield shows -> convex obstacles: MuJoCo collides a mesh as its convex hull.

What hangs together is one body, which harness.world.solids.convex takes apart. A vaulted ceiling of a
structure (what faces down, HEADROOM above the ground) is touched by nobody: it stays, to be seen.

A body on which a rover can stand (STANDING_AREA no steeper than STEEPEST) is a structure, as a bridge:
its gentle triangles are deck, which is ground; others are rocks where they are no higher than the rover
clears, else hazards. Other bodies are rocks or hazards by the height of their top above the ground.
"""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from harness.base.errors import UsageError
from harness.base.mesh import Mesh, areas_and_normals
from harness.base.mesh_file import SIMPLER
from harness.world.heightfield import Heightfield
from harness.world.obstacles import HEADROOM, Obstacle, ObstacleKind, convex, outline, surface, top
from harness.world.solid import Primitive, Solid
from harness.world.solids.convex import FEWEST, Points, convex_pieces, own_hull, slab
from harness.world.solids.kinds import Kind
from harness.world.solids.surface import SAMPLES, on_map

STANDING_AREA = 1.0  # [m2]
STEEPEST = math.radians(35.0)
SMALLEST_AREA = 1e-6  # [m2] of a triangle
FLUSH = 0.005  # [m] above the ground up to which a body counts as buried
MOST_PIECES = 6000
DOWNWARD = 0.1  # downward part of the normal of a ceiling


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
    whole = own_hull(body, areas)
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
        and slab(ceiling, areas[is_ceiling], normals[is_ceiling]) is None
    ):
        yield surface(ceiling.vertices, ceiling.faces)
        chosen &= ~is_ceiling
    for value in np.unique(kinds[chosen]).tolist():
        alike = np.flatnonzero(chosen & (kinds == value))
        pieces = convex_pieces(body, alike, areas, normals)
        yield from (convex(ObstacleKind(value), corners) for corners in pieces)


def _is_ceiling(body: Mesh, normals: Points, ground: Heightfield) -> NDArray[np.bool_]:
    x, y, z = np.moveaxis(SAMPLES @ body.corners, -1, 0)
    is_high = (z > ground.heights_at(x, y) + HEADROOM).all(axis=1)
    return np.asarray(is_high & (normals[:, 2] < -DOWNWARD))


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
