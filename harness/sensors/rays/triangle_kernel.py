"""Rays against triangles that stand still, compiled by numba: a tree of boxes around them.

The tree is binary and complete: node n has the children 2 n + 1 and 2 n + 2, its leaves hold at most
LEAF triangles each. A ray walks it front to back with a stack of its own, past boxes that it does not
meet before the nearest hit so far. Triangles are hit from both sides, as MuJoCo's meshes are.
"""

import math

import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel

MISS = math.inf
LEAF = 4  # triangles
DEEPEST = 64  # entries of the stack
ON_EDGE = 1e-12  # of a barycentric coordinate: no ray slips through between two triangles

Vector = tuple[float, float, float]


def build_tree(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns (boxes, triangles) of one triangle or more, shape (f, 3, 3), as cast_triangles takes them.

    At each node they are halved at the median of their middles, along the longest axis.
    """
    count = len(corners)
    depth = max(0, math.ceil(math.log2(count / LEAF)))
    leaves = 1 << depth
    boxes = np.empty((2 * leaves - 1, 6))
    boxes[:, :3], boxes[:, 3:] = np.inf, -np.inf
    triangles = np.full((leaves * LEAF, 9), np.nan)
    order, sizes = _halved(corners.mean(axis=1), depth)
    held, starts = corners[order], np.cumsum(sizes) - sizes
    edges = [held[:, 0], held[:, 1] - held[:, 0], held[:, 2] - held[:, 0]]
    first_of_leaf = np.repeat(np.arange(leaves) * LEAF - starts, sizes)
    triangles[first_of_leaf + np.arange(count)] = np.concatenate(edges, axis=1)
    boxes[leaves - 1 :, :3] = np.minimum.reduceat(held.min(axis=1), starts)
    boxes[leaves - 1 :, 3:] = np.maximum.reduceat(held.max(axis=1), starts)
    for level in range(depth - 1, -1, -1):
        first = (1 << level) - 1
        below = boxes[2 * first + 1 : 4 * first + 3].reshape(-1, 2, 6)
        boxes[first : 2 * first + 1, :3] = below[..., :3].min(axis=1)
        boxes[first : 2 * first + 1, 3:] = below[..., 3:].max(axis=1)
    return boxes, triangles


def _halved(middles: NDArray[np.float64], depth: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Triangles leaf by leaf, and how many are in each of the 2**depth leaves: never none."""
    order, sizes = np.arange(len(middles)), np.array([len(middles)])
    for _ in range(depth):
        starts, placed = np.cumsum(sizes) - sizes, middles[order]
        spread = np.maximum.reduceat(placed, starts) - np.minimum.reduceat(placed, starts)
        part = np.repeat(np.arange(len(sizes)), sizes)
        along = placed[np.arange(len(order)), spread.argmax(axis=1)[part]]
        order = order[np.lexsort((along, part))]
        sizes = np.column_stack([(sizes + 1) // 2, sizes // 2]).ravel()
    return order, sizes


@inlined
def _enters(box: NDArray[np.float64], origin: Vector, pace: Vector, limit: float) -> float:
    """First t in 0..limit within a box, or MISS; `pace` is 1 / direction."""
    begin, end = 0.0, limit
    for axis in range(3):
        if math.isinf(pace[axis]):
            if origin[axis] < box[axis] or origin[axis] > box[axis + 3]:
                return MISS
            continue
        one = (box[axis] - origin[axis]) * pace[axis]
        other = (box[axis + 3] - origin[axis]) * pace[axis]
        begin, end = max(begin, min(one, other)), min(end, max(one, other))
    return begin if begin <= end else MISS


@inlined
def _hit(triangle: NDArray[np.float64], origin: Vector, ray: Vector) -> float:
    """Where a ray meets a triangle (Moeller and Trumbore 1997), or MISS."""
    ax, ay, az = triangle[3], triangle[4], triangle[5]
    bx, by, bz = triangle[6], triangle[7], triangle[8]
    px, py, pz = ray[1] * bz - ray[2] * by, ray[2] * bx - ray[0] * bz, ray[0] * by - ray[1] * bx
    determinant = ax * px + ay * py + az * pz
    if not abs(determinant) > 1e-300:  # along it, or no triangle at all (NaN)
        return MISS
    x, y, z = origin[0] - triangle[0], origin[1] - triangle[1], origin[2] - triangle[2]
    u = (x * px + y * py + z * pz) / determinant
    if not -ON_EDGE <= u <= 1.0 + ON_EDGE:
        return MISS
    qx, qy, qz = y * az - z * ay, z * ax - x * az, x * ay - y * ax
    v = (ray[0] * qx + ray[1] * qy + ray[2] * qz) / determinant
    if v < -ON_EDGE or u + v > 1.0 + ON_EDGE:
        return MISS
    distance: float = (bx * qx + by * qy + bz * qz) / determinant
    return distance if distance >= 0.0 else MISS


@kernel("void(float64[:,::1], float64[:,::1], float64[::1], float64[:,::1], float64, float64[::1])")
def cast_triangles(
    boxes: NDArray[np.float64],
    triangles: NDArray[np.float64],
    origin: NDArray[np.float64],
    directions: NDArray[np.float64],
    range_max: float,
    ranges: NDArray[np.float64],
) -> None:
    """Lowers `ranges` to the distance of the triangles where that is nearer.

    Args:
        boxes: Of the tree's nodes: lowest x, y, z, then highest [m], shape (nodes, 6).
        triangles: First corner and the edges from it [m], by leaves, shape (leaves * LEAF, 9).
        origin: Where the rays start in the world [m], shape (3,).
        directions: Unit vectors in the world, shape (n, 3).
        range_max: Where rays end [m].
        ranges: Distances [m] to what else was hit, or inf; shape (n,).
    """
    start = (origin[0], origin[1], origin[2])
    first_leaf = boxes.shape[0] // 2
    nodes = np.empty(DEEPEST, np.int64)
    entries = np.empty(DEEPEST, np.float64)
    for i in range(ranges.shape[0]):
        ray = (directions[i, 0], directions[i, 1], directions[i, 2])
        pace = (
            1.0 / ray[0] if ray[0] != 0.0 else math.inf,
            1.0 / ray[1] if ray[1] != 0.0 else math.inf,
            1.0 / ray[2] if ray[2] != 0.0 else math.inf,
        )
        limit = min(ranges[i], range_max)
        nodes[0], entries[0] = 0, _enters(boxes[0], start, pace, limit)
        waiting = 1
        while waiting > 0:
            waiting -= 1
            node = nodes[waiting]
            if entries[waiting] > limit or entries[waiting] == MISS:
                continue
            if node >= first_leaf:
                leaf = node - first_leaf
                for k in range(leaf * LEAF, (leaf + 1) * LEAF):
                    hit = _hit(triangles[k], start, ray)
                    if hit <= limit:
                        limit = hit
                        ranges[i] = hit
                continue
            near, far = 2 * node + 1, 2 * node + 2
            t_near = _enters(boxes[near], start, pace, limit)
            t_far = _enters(boxes[far], start, pace, limit)
            if t_far < t_near:
                near, far, t_near, t_far = far, near, t_far, t_near
            if t_far < MISS:
                nodes[waiting], entries[waiting] = far, t_far
                waiting += 1
            if t_near < MISS:
                nodes[waiting], entries[waiting] = near, t_near
                waiting += 1
