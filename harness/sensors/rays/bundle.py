"""Rays in any directions from one point, against all that a lidar can see: exact, as MuJoCo's are."""

import ctypes
import math
from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.base.compiled import inlined, kernel, native
from harness.base.passing import doubles, fill, filled, integers, layout, reader, singles, truths
from harness.physics.c_functions import address_of
from harness.sensors.rays import arrays
from harness.sensors.rays.cone_kernel import clear_ways
from harness.sensors.rays.heightfield_kernel import cast_rays
from harness.sensors.rays.obstacle_kernel import cast_bundle
from harness.sensors.rays.triangle_kernel import cast_triangles

BINS_AROUND = 180
BIN = math.tau / BINS_AROUND  # [rad]
TERRAIN, OBSTACLES = ("heights", "pyramid", "levels", "frame"), ("geoms", "sizes")
MUJOCO = ("geom_xpos", "geom_xmat", "site_xpos", "site_xmat")
OWN = ("local", "order", "starts", "grid", "pose", "directions", "clear", "distances", "met")
RAYS = layout((*TERRAIN, *OBSTACLES, *MUJOCO, *OWN, "place"), ("range_max", "has_meshes"))

Doubles = NDArray[np.float64]
Integers = NDArray[np.int64]

_passed = reader(RAYS)
_kinematics = native(ctypes.c_void_p, ctypes.c_void_p)


@inlined
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


class Surroundings:
    """What rays of a scene can meet, as the kernels take it.

    Attributes:
        terrain: The ground.
        obstacles: All geoms that are no meshes, those of other rovers included.
        triangles: Of the meshes that stand still; None without any.
        has_meshes: Whether there are meshes, those that move included.
    """

    def __init__(self, model: mujoco.MjModel, others: Sequence[int] = ()) -> None:
        self.terrain = arrays.heightfield_arrays(model)
        self.obstacles = arrays.obstacle_arrays(model, others)
        self.triangles = arrays.triangle_arrays(model)
        self._moving, self._radii = arrays.moving_meshes(model, others), model.geom_rbound
        self.has_meshes = self.triangles is not None or bool(self._moving)

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

    Attributes:
        on_obstacle: Of each ray of the last cast, whether it met an obstacle, shape (n,).
    """

    def __init__(self, surroundings: Surroundings, directions: Doubles, range_max: float) -> None:
        self._surroundings, self._range_max = surroundings, range_max
        self._local, n = np.ascontiguousarray(directions, np.float64), len(directions)
        self.pose, self._directions = np.empty((4, 3)), np.empty_like(self._local)
        self.distances, self.on_obstacle = np.empty(n), np.zeros(n, bool)
        own = (self._local, *sorted_into_bins(self._local), self.pose, self._directions, np.empty(n))
        self._kept = dict(zip(OWN, (*own, self.distances, self.on_obstacle), strict=True))
        self._kept |= zip(TERRAIN, surroundings.terrain, strict=True)
        self._kept |= zip(OBSTACLES, surroundings.obstacles, strict=True)
        self._place = self._kept["place"] = np.zeros(4, np.int64)
        numbers = {"range_max": range_max, "has_meshes": surroundings.has_meshes}
        self._record = filled(RAYS, self._kept, numbers)
        self._address = int(self._record.ctypes.data)
        self._data: mujoco.MjData | None = None

    def cast(self, data: mujoco.MjData, pose: Doubles) -> Doubles:
        """Returns distances [m], shape (n,), +inf beyond range_max; the next call reuses the array.

        Args:
            data: Where the obstacles are.
            pose: The sensor's origin in the world [m] and below it R_world_sensor, shape (4, 3).
        """
        address = self.passed(data)
        self.pose[:] = pose
        if self._surroundings.has_meshes:
            turn(self._local, pose, self._directions)
            self.distances.fill(np.inf)
            self._surroundings.cast_meshes(
                data, pose[0], self._directions, self._range_max, self.distances
            )
        cast_rays_of(address)
        return self.distances

    def passed(self, data: mujoco.MjData) -> int:
        """Returns the address of what `cast_rays_of` is passed for a state, as long as both are kept."""
        if data is not self._data:
            self._data = data
            fill(self._record, {name: getattr(data, name) for name in MUJOCO})
        return self._address

    def passed_at(self, site: int, model: mujoco.MjModel, data: mujoco.MjData) -> int:
        """Returns what `passed` does; then rays start from a site, wherever the state has it by then.

        Args:
            site: Its index.
            model: The compiled scene.
            data: The state.
        """
        self._place[:] = address_of("mj_kinematics"), model._address, data._address, site  # noqa: SLF001 - no other name
        return self.passed(data)


@inlined
def _put(place: Integers, positions: Doubles, axes: Doubles, pose: Doubles) -> None:
    """Sets a bundle's pose to that of its site."""
    _kinematics(place[0], (place[1], place[2]))  # poses are one step old
    site = place[3]
    pose[0] = positions[site]
    for row in range(3):
        pose[1 + row] = axes[site, 3 * row : 3 * row + 3]


@kernel("void(int64)")
def cast_rays_of(address: int) -> None:
    """Sets distances, and whether they are those of obstacles, of a bundle in a state.

    Args:
        address: As `RayBundle.passed` gives it. The pose stands in the bundle, or is that of a site.
            Where there are meshes so do directions in the world, and distances are those to meshes.
    """
    of = _passed(address)
    pose, directions, levels = doubles(of["pose"]), doubles(of["directions"]), integers(of["levels"])
    heights, pyramid, frame = (
        singles(of["heights"]),
        singles(of["pyramid"]),
        doubles(of["frame"]),
    )
    distances, clear = doubles(of["distances"]).ravel(), doubles(of["clear"]).ravel()
    range_max, met = of["range_max"], truths(of["met"]).ravel()
    order = integers(of["order"]).ravel()
    place = integers(of["place"]).ravel()
    if place[0]:
        _put(place, doubles(of["site_xpos"]), doubles(of["site_xmat"]), pose)
    if not of["has_meshes"]:
        turn(doubles(of["local"]), pose, directions)
        distances[:] = np.inf
    cast_bundle(
        integers(of["geoms"]),
        doubles(of["sizes"]),
        doubles(of["geom_xpos"]),
        doubles(of["geom_xmat"]),
        pose,
        directions,
        order,
        integers(of["starts"]),
        doubles(of["grid"]).ravel(),
        range_max,
        distances,
    )
    nearest = distances.copy()
    bounds = (heights.shape, pyramid, levels, frame, pose[0], directions, order)
    clear_ways(*bounds, range_max, distances, clear)
    # Obstacles first: the terrain is then walked no further than to them.
    cast_rays(heights, pyramid, levels, frame, pose[0], directions, clear, range_max, distances)
    for ray in range(distances.size):
        met[ray] = nearest[ray] < np.inf and distances[ray] == nearest[ray]


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
