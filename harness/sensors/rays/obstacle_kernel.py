"""Beams against boxes, cylinders, capsules, ellipsoids, compiled by numba.

Each obstacle is asked only by the beams whose directions its bounding sphere covers, by the bins of
azimuth and elevation into which they are sorted once.
The shapes are convex: a ray is inside for one interval of t, and the hit is the interval's begin, or
its end if the ray starts inside, as MuJoCo has it.
"""

import math

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel
from harness.sensors.rays.heightfield_kernel import MISS, Interval, slab

SLACK = 1e-6  # [rad]
BOX = int(mujoco.mjtGeom.mjGEOM_BOX)
CYLINDER = int(mujoco.mjtGeom.mjGEOM_CYLINDER)
CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
ELLIPSOID = int(mujoco.mjtGeom.mjGEOM_ELLIPSOID)

Vector = tuple[float, float, float]


@inlined
def _ball(start: Vector, speed: Vector, scale: Vector) -> Interval:
    """Where along a ray its scaled coordinates lie in the unit ball (a scale of 0: a cylinder)."""
    px, py, pz = scale[0] * start[0], scale[1] * start[1], scale[2] * start[2]
    dx, dy, dz = scale[0] * speed[0], scale[1] * speed[1], scale[2] * speed[2]
    a = dx * dx + dy * dy + dz * dz
    b = px * dx + py * dy + pz * dz
    c = px * px + py * py + pz * pz - 1.0
    if a == 0.0:
        if c <= 0.0:
            return -math.inf, math.inf
        return math.inf, -math.inf
    discriminant = b * b - a * c
    if discriminant < 0.0:
        return math.inf, -math.inf
    root = math.sqrt(discriminant)
    return (-b - root) / a, (-b + root) / a


@inlined
def _joined(one: Interval, other: Interval) -> Interval:
    """What two intervals that overlap or are empty cover together; an empty `other` is inf to -inf."""
    if one[0] > one[1]:
        return other
    return min(one[0], other[0]), max(one[1], other[1])


@inlined
def _capsule(start: Vector, speed: Vector, size: Vector) -> Interval:
    """Where along a ray it lies in a cylinder of that radius and half length, or in a ball at an end."""
    inverse = 1.0 / size[0]
    round_begin, round_end = _ball(start, speed, (inverse, inverse, 0.0))
    flat_begin, flat_end = slab(start[2], speed[2], -size[1], size[1])
    inside = max(round_begin, flat_begin), min(round_end, flat_end)
    scale = (inverse, inverse, inverse)
    upper = _ball((start[0], start[1], start[2] - size[1]), speed, scale)
    lower = _ball((start[0], start[1], start[2] + size[1]), speed, scale)
    return _joined(inside, _joined(upper, lower))


@inlined
def _hit_shape(kind: int, size: Vector, start: Vector, speed: Vector) -> float:
    """First t >= 0 on the surface of a shape, in its own frame."""
    if kind == ELLIPSOID:
        begin, end = _ball(start, speed, (1.0 / size[0], 1.0 / size[1], 1.0 / size[2]))
    elif kind == CYLINDER:
        round_begin, round_end = _ball(start, speed, (1.0 / size[0], 1.0 / size[0], 0.0))
        flat_begin, flat_end = slab(start[2], speed[2], -size[1], size[1])
        begin, end = max(round_begin, flat_begin), min(round_end, flat_end)
    elif kind == CAPSULE:
        begin, end = _capsule(start, speed, size)
    else:
        x_begin, x_end = slab(start[0], speed[0], -size[0], size[0])
        y_begin, y_end = slab(start[1], speed[1], -size[1], size[1])
        z_begin, z_end = slab(start[2], speed[2], -size[2], size[2])
        begin, end = max(x_begin, y_begin, z_begin), min(x_end, y_end, z_end)
    if begin > end or end < 0.0:
        return MISS
    return begin if begin >= 0.0 else end


@inlined
def _to_local(matrix: NDArray[np.float64], x: float, y: float, z: float) -> Vector:
    """The transposed row-major 3x3 matrix times a vector."""
    return (
        matrix[0] * x + matrix[3] * y + matrix[6] * z,
        matrix[1] * x + matrix[4] * y + matrix[7] * z,
        matrix[2] * x + matrix[5] * y + matrix[8] * z,
    )


@inlined
def _cap(center: Vector, radius: float) -> tuple[float, float, float, float]:
    """Azimuth and elevation of a sphere, and how far it reaches about them."""
    x, y, z = center
    distance = math.sqrt(x * x + y * y + z * z)
    if distance <= radius:
        return 0.0, math.pi, 0.0, math.pi
    elevation, reach = math.asin(z / distance), math.asin(radius / distance)
    width = math.pi
    if abs(elevation) + reach < 0.5 * math.pi:
        width = math.asin(min(math.sin(reach) / math.cos(elevation), 1.0))
    return math.atan2(y, x), width, elevation, reach


@kernel()
def cast_bundle(  # noqa: PLR0913, PLR0917 - numba takes arrays, no structures of them
    obstacles: NDArray[np.int64],
    sizes: NDArray[np.float64],
    positions: NDArray[np.float64],
    matrices: NDArray[np.float64],
    pose: NDArray[np.float64],
    directions: NDArray[np.float64],
    order: NDArray[np.int64],
    starts: NDArray[np.int64],
    grid: NDArray[np.float64],
    range_max: float,
    ranges: NDArray[np.float64],
) -> None:
    """Lowers `ranges` to the distance of the obstacles where that is nearer.

    Args:
        obstacles: Geom and kind (BOX, CYLINDER, CAPSULE or ELLIPSOID) of each, shape (k, 2).
        sizes: Half sizes as MuJoCo has them and the bounding radius [m], shape (k, 4).
        positions: World positions of all geoms [m], shape (ngeom, 3).
        matrices: World rotations of all geoms, shape (ngeom, 9).
        pose: World position [m] of the bundle's frame, then its rotation's rows, shape (4, 3).
        directions: Beams as unit vectors in the world, shape (n, 3).
        order: The beams bin by bin, shape (n,).
        starts: Where each bin begins in it, shape (bins of elevation, bins of azimuth + 1).
        grid: Lowest elevation and the bins' size in elevation and azimuth [rad]; azimuths begin at -pi.
        range_max: Where beams end [m].
        ranges: Distances [m] to what else was hit, or inf; shape (n,).
    """
    origin, axes = pose[0], pose[1:].ravel()
    rows, cols = starts.shape[0], starts.shape[1] - 1
    for k in range(obstacles.shape[0]):
        geom, kind = obstacles[k, 0], obstacles[k, 1]
        position, matrix = positions[geom], matrices[geom]
        x, y, z = position[0] - origin[0], position[1] - origin[1], position[2] - origin[2]
        radius, squared = sizes[k, 3], x * x + y * y + z * z
        if squared > (range_max + radius) ** 2:
            continue
        azimuth, width, elevation, reach = _cap(_to_local(axes, x, y, z), radius)
        # Angles that rounding might leave a hair too small are SLACK wider.
        first_row = max(math.floor((elevation - reach - SLACK - grid[0]) / grid[1]), 0.0)
        last_row = min(math.floor((elevation + reach + SLACK - grid[0]) / grid[1]), rows - 1.0)
        first = math.floor((azimuth - width - SLACK + math.pi) / grid[2])
        last = min(math.floor((azimuth + width + SLACK + math.pi) / grid[2]), first + cols - 1.0)
        size, start = (sizes[k, 0], sizes[k, 1], sizes[k, 2]), _to_local(matrix, -x, -y, -z)
        beside = squared - radius * radius
        for row in range(int(first_row), int(last_row) + 1):
            for turned in range(int(first), int(last) + 1):
                col = turned % cols
                for place in range(starts[row, col], starts[row, col + 1]):
                    i = order[place]
                    beam = directions[i]
                    along = beam[0] * x + beam[1] * y + beam[2] * z
                    if beside > 0.0 and (along < 0.0 or along * along < beside * (1.0 - SLACK)):
                        continue
                    speed = _to_local(matrix, beam[0], beam[1], beam[2])
                    hit = _hit_shape(kind, size, start, speed)
                    if hit <= min(ranges[i], range_max):
                        ranges[i] = hit
