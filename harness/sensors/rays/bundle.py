"""Rays in any directions from one point, against all that a lidar can see: exact, as MuJoCo's are."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import kernel
from harness.physics.world_geoms import OBSTACLE_GROUP
from harness.sensors.rays import arrays
from harness.sensors.rays.heightfield_kernel import cast_rays
from harness.sensors.rays.horizon_kernel import RINGS, SECTORS, clear_ways, highest_points
from harness.sensors.rays.obstacle_kernel import cast_bundle
from harness.sensors.rays.triangle_kernel import cast_triangles

BINS_AROUND = 180
BIN = math.tau / BINS_AROUND  # [rad]

Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]


class Surroundings:
    """What rays of a scene can meet, as the kernels take it.

    Attributes:
        terrain: The ground.
        obstacles: All geoms that are no meshes, those of other rovers included.
        triangles: Of the meshes that stand still; None without any.
    """

    def __init__(self, model: mujoco.MjModel, others: Sequence[int] = ()) -> None:
        self.terrain = arrays.heightfield_arrays(model)
        self.obstacles = arrays.obstacle_arrays(model, OBSTACLE_GROUP, others)
        self.triangles = arrays.triangle_arrays(model, OBSTACLE_GROUP)
        self._moving, self._radii = arrays.moving_meshes(model, others), model.geom_rbound

    def cast_meshes(
        self,
        data: mujoco.MjData,
        origin: Doubles,
        directions: Doubles,
        range_max: float,
        distances: Doubles,
    ) -> None:
        """Lowers distances to those of the meshes, those of other rovers included, as cast_triangles.

        Args:
            data: Where they are.
            origin: Of the rays, in the world [m].
            directions: Unit vectors in the world, shape (n, 3).
            range_max: Where rays end [m].
            distances: To what else was hit [m], or inf, shape (n,).
        """
        if self.triangles is not None:
            cast_triangles(*self.triangles, origin, directions, range_max, distances)
        for geom, boxes, triangles in self._moving:
            away, axes = origin - data.geom_xpos[geom], data.geom_xmat[geom].reshape(3, 3)
            if math.hypot(*away) <= range_max + self._radii[geom]:
                cast_triangles(boxes, triangles, away @ axes, directions @ axes, range_max, distances)


class RayBundle:
    """Rays in fixed directions of a sensor's frame.

    Args:
        surroundings: What they can meet; several bundles may share them.
        directions: Unit vectors in the sensor's frame, shape (n, 3).
        range_max: Where they end [m].
        horizon: Whether to look first how far the ground lets rays go, which takes longer than a fan of
            hundreds of rays and saves time with thousands; what they meet is the same.

    Attributes:
        on_obstacle: Of each ray of the last cast, whether it met an obstacle, shape (n,).
    """

    def __init__(
        self, surroundings: Surroundings, directions: Doubles, range_max: float, *, horizon: bool = True
    ) -> None:
        self._surroundings, self._range_max, self._horizon = surroundings, range_max, horizon
        self._local = np.ascontiguousarray(directions, np.float64)
        self._bins = sorted_into_bins(self._local)
        self._directions = np.empty_like(self._local)
        self._profile = np.empty((SECTORS, RINGS))
        self._clear, self._distances = np.zeros(len(directions)), np.empty(len(directions))
        self.on_obstacle = np.zeros(len(directions), bool)

    def cast(self, data: mujoco.MjData, pose: Doubles) -> Doubles:
        """Returns distances [m], shape (n,), +inf beyond range_max; the next call reuses the array.

        Args:
            data: Where the obstacles are.
            pose: The sensor's origin in the world [m] and below it R_world_sensor, shape (4, 3).
        """
        directions, distances, origin = self._directions, self._distances, pose[0]
        terrain, obstacles = self._surroundings.terrain, self._surroundings.obstacles
        turn(self._local, pose, directions)
        distances.fill(np.inf)
        order, starts, grid = self._bins
        poses = data.geom_xpos, data.geom_xmat, pose
        cast_bundle(*obstacles, *poses, directions, order, starts, grid, self._range_max, distances)
        self._surroundings.cast_meshes(data, origin, directions, self._range_max, distances)
        np.isfinite(distances, out=self.on_obstacle)
        nearest = distances.copy()
        if self._horizon:
            highest_points(terrain[0].shape, *terrain[1:], origin, self._range_max, self._profile)
            clear_ways(self._profile, terrain[3], origin, directions, self._range_max, self._clear)
        # Obstacles first: the terrain is then walked no further than to them.
        cast_rays(*terrain, origin, directions, self._clear, self._range_max, distances)
        self.on_obstacle &= distances == nearest
        return distances


@kernel("void(float64[:,::1], float64[:,::1], float64[:,::1])")
def turn(local: Doubles, pose: Doubles, directions: Doubles) -> None:
    """Sets `directions` to vectors of a frame in the world; BLAS would start threads.

    Args:
        local: In the frame, shape (n, 3), as is the result.
        pose: Of the frame: origin and below it its rotation, shape (4, 3).
        directions: The result.
    """
    for i in range(local.shape[0]):
        for axis in range(3):
            row = pose[axis + 1]
            directions[i, axis] = local[i, 0] * row[0] + local[i, 1] * row[1] + local[i, 2] * row[2]


def sorted_into_bins(directions: Doubles) -> tuple[Integers, Integers, Doubles]:
    """The rays bin by bin, where the bins begin, and their grid, as cast_bundle takes them."""
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    elevation = np.arcsin(np.clip(directions[:, 2], -1.0, 1.0))
    lowest = float(elevation.min())
    rows = int((elevation.max() - lowest) / BIN) + 1
    row = np.minimum(((elevation - lowest) / BIN).astype(np.int64), rows - 1)
    col = np.clip(((azimuth + math.pi) / BIN).astype(np.int64), 0, BINS_AROUND - 1)
    place = row * BINS_AROUND + col
    ends = np.cumsum(np.bincount(place, minlength=rows * BINS_AROUND)).reshape(rows, BINS_AROUND)
    begins = np.concatenate([[0], ends.ravel()[:-1]]).reshape(rows, BINS_AROUND)
    starts = np.hstack([begins, ends[:, -1:]]).astype(np.int64)
    order = np.argsort(place, kind="stable").astype(np.int64)
    return order, np.ascontiguousarray(starts), np.array([lowest, BIN, BIN])
