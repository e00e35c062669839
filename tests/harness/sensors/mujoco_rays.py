"""MuJoCo's own rays: what the lidars and the height scan are held to."""

from collections.abc import Collection

import mujoco
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def meets(
    model: mujoco.MjModel, data: mujoco.MjData, origin: Array, directions: Array, groups: Collection[int]
) -> tuple[NDArray[np.int32], Array]:
    """Which geom of those groups each ray meets first, -1 for none, and where [m], inf for none."""
    count, seen = len(directions), np.isin(np.arange(6), [*groups]).astype(np.uint8)
    geoms, distances = np.empty(count, np.int32), np.empty(count)
    rays = np.ascontiguousarray(directions).ravel()
    mujoco.mj_multiRay(
        model, data, origin, rays, seen, 1, -1, geoms, distances, None, count, mujoco.mjMAXVAL
    )
    return geoms, np.where(geoms < 0, np.inf, distances)
