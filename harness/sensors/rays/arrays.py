"""A model's heightfield and obstacles as the arrays that the kernels take.

MuJoCo keeps float32 heights normalised to 0..1. Rays are cast against those, not against the float64
heights of the world they came from, so that its own ray caster is met to rounding. It asks every beam
about every geom; a planar fan can go from obstacle to beams instead, with the same hits.
"""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.physics.world_geoms import OBSTACLE_GROUP, SOIL_ROOM, TERRAIN, heights_of
from harness.sensors.rays.obstacle_kernel import BOX, CAPSULE, CYLINDER, ELLIPSOID
from harness.sensors.rays.triangle_kernel import build_tree

MESH, SPHERE = int(mujoco.mjtGeom.mjGEOM_MESH), int(mujoco.mjtGeom.mjGEOM_SPHERE)
COARSEST_LEVEL = 6  # blocks of 64 cells; coarser ones are hardly ever skipped whole

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]


def heightfield_arrays(model: mujoco.MjModel) -> tuple[Floats, Floats, Integers, Doubles]:
    """Returns heights, pyramid, levels and frame of the terrain as cast_rays takes them.

    The heights are a view onto the model's: they must not be edited afterwards, but for those of soil,
    for whose rise the pyramid has room.
    """
    geom = model.geom(TERRAIN).id
    field = model.geom_dataid[geom]
    heights = heights_of(model, geom)
    rows, cols = heights.shape
    half_x, half_y, relief, thickness = model.hfield_size[field]
    frame = np.array(
        [
            model.geom_pos[geom] - (half_x, half_y, 0.0),
            (0.5 * (cols - 1) / half_x, 0.5 * (rows - 1) / half_y, 1.0 / relief),
            (-thickness / relief, heights.max(), 0.0),
        ]
    )
    pyramid, levels = _max_pyramid(heights)
    if not model.geom_contype[geom]:  # of soil, whose berms rise
        room = SOIL_ROOM / relief
        pyramid += np.float32(room)
        frame[2, 1] += room
    return heights, pyramid, levels, frame


def obstacle_arrays(model: mujoco.MjModel, others: Sequence[int]) -> tuple[Integers, Doubles]:
    """Returns obstacles and other geoms, but for meshes, with kinds, and sizes, as cast_bundle has them.

    ValueError if one of them is neither mesh, box, cylinder, capsule, ellipsoid nor sphere.
    """
    taken = (model.geom_group == OBSTACLE_GROUP) | np.isin(np.arange(model.ngeom), others)
    geoms = np.flatnonzero(taken & (model.geom_type != MESH))
    kinds, round_ = model.geom_type[geoms], model.geom_type[geoms] == SPHERE
    kinds[round_] = ELLIPSOID
    unseen = geoms[~np.isin(kinds, (BOX, CYLINDER, CAPSULE, ELLIPSOID))]
    if unseen.size:
        raise ValueError(
            f"obstacle '{model.geom(unseen[0]).name}' has a shape that the lidar cannot see; "
            "available: box, cylinder, capsule, ellipsoid, sphere, mesh"
        )
    half = model.geom_size[geoms]
    half[round_] = half[round_, :1]
    sizes = np.column_stack([half, model.geom_rbound[geoms]])
    return np.column_stack([geoms, kinds]).astype(np.int64), sizes


def triangle_arrays(model: mujoco.MjModel) -> tuple[Doubles, Doubles] | None:
    """Returns the obstacles that are meshes as cast_triangles takes them; None without any.

    They must stand still: they are where they are when nothing has moved yet.
    """
    geoms = np.flatnonzero((model.geom_group == OBSTACLE_GROUP) & (model.geom_type == MESH))
    if not geoms.size:
        return None
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    corners = []
    for geom in geoms:
        axes = data.geom_xmat[geom].reshape(3, 3)
        corners.append(_triangles(model, geom) @ axes.T + data.geom_xpos[geom])
    return build_tree(np.concatenate(corners))


def moving_meshes(model: mujoco.MjModel, geoms: Sequence[int]) -> list[tuple[int, Doubles, Doubles]]:
    """Returns those geoms that are meshes, each with the arrays of its triangles in its frame."""
    meshes = (geom for geom in geoms if model.geom_type[geom] == MESH)
    return [(geom, *build_tree(_triangles(model, geom))) for geom in meshes]


def _triangles(model: mujoco.MjModel, geom: int | np.signedinteger[Any]) -> Doubles:
    """The corners of a mesh in the geom's frame, shape (triangles, 3, 3)."""
    mesh = model.mesh(int(model.geom_dataid[geom]))
    vertices = model.mesh_vert[mesh.vertadr[0] :][: mesh.vertnum[0]].astype(np.float64)
    return np.asarray(vertices[model.mesh_face[mesh.faceadr[0] :][: mesh.facenum[0]]])


def _max_pyramid(heights: Floats) -> tuple[Floats, Integers]:
    """Maxima over blocks of 2, 4, 8... cells, and where each level begins and its width.

    The first row has those of each block, the second those of it and its eight neighbours together.
    Level 0, the cells, is not stored: looking at a cell's four heights decides it at once.
    """
    across = np.maximum(heights[:, :-1], heights[:, 1:])
    blocks = np.maximum(across[:-1], across[1:])
    maxima, widened, levels, start = [np.empty(0, np.float32)], [np.empty(0, np.float32)], [(0, 0)], 0
    while max(blocks.shape) > 1 and len(levels) <= COARSEST_LEVEL:
        blocks = _halved(_halved(blocks).T).T
        levels.append((start, blocks.shape[1]))
        maxima.append(blocks.ravel())
        widened.append(_widened(_widened(blocks).T).T.ravel())
        start += blocks.size
    return np.stack([np.concatenate(maxima), np.concatenate(widened)]), np.array(levels, np.int64)


def _halved(blocks: Floats) -> Floats:
    """Maxima of each two neighbouring rows; a last row without neighbour stays as it is."""
    halved, pairs = blocks[::2].copy(order="K"), len(blocks) // 2
    np.maximum(halved[:pairs], blocks[1::2], out=halved[:pairs])
    return halved


def _widened(blocks: Floats) -> Floats:
    """Maxima of each row and its neighbours."""
    widened = blocks.copy(order="K")
    np.maximum(widened[1:], blocks[:-1], out=widened[1:])
    np.maximum(widened[:-1], blocks[1:], out=widened[:-1])
    return widened
