"""Rays against a model's heightfield: the heights MuJoCo really has, and a pyramid of their maxima.

MuJoCo keeps float32 heights normalised to 0..1. Rays are cast against those, not against the
float64 heights of the world they came from, so that its own ray caster is met to rounding.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from harness.sensors.rays.heightfield_kernel import cast_rays

COARSEST_LEVEL = 6  # blocks of 64 cells; coarser ones are hardly ever skipped whole


@dataclass(frozen=True, eq=False)
class HeightfieldRays:
    """A heightfield prepared for ray casting; see cast_rays for the arrays.

    The heights are a view onto the model's: they must not be edited afterwards.
    """

    heights: NDArray[np.float32]
    pyramid: NDArray[np.float32]
    levels: NDArray[np.int64]
    frame: NDArray[np.float64]

    @classmethod
    def from_model(cls, model: mujoco.MjModel, geom_name: str = "terrain") -> "HeightfieldRays":
        """Prepares the heightfield of a geom that stands upright in the world.

        Raises:
            ValueError: The geom is no heightfield, or it is turned or moves.
        """
        geom = model.geom(geom_name).id
        if model.geom_type[geom] != mujoco.mjtGeom.mjGEOM_HFIELD:
            message = f"geom '{geom_name}' is not a heightfield"
            raise ValueError(message)
        if model.geom_bodyid[geom] != 0 or not np.array_equal(model.geom_quat[geom], (1, 0, 0, 0)):
            message = f"heightfield '{geom_name}' must be upright and fixed to the world"
            raise ValueError(message)
        field = model.geom_dataid[geom]
        rows, cols = int(model.hfield_nrow[field]), int(model.hfield_ncol[field])
        start = int(model.hfield_adr[field])
        heights = model.hfield_data[start : start + rows * cols].reshape(rows, cols)
        half_x, half_y, relief, thickness = model.hfield_size[field]
        frame = np.array(
            [
                model.geom_pos[geom] - (half_x, half_y, 0.0),
                (0.5 * (cols - 1) / half_x, 0.5 * (rows - 1) / half_y, 1.0 / relief),
                (-thickness / relief, heights.max(), 0.0),
            ]
        )
        return cls(heights, *_max_pyramid(heights), frame)

    def cast(
        self,
        origin: NDArray[np.float64],
        directions: NDArray[np.float64],
        range_max: float,
        ranges: NDArray[np.float64],
    ) -> None:
        """Lowers `ranges` [m] where the terrain is nearer; directions are unit vectors, (n, 3)."""
        cast_rays(
            self.heights,
            self.pyramid,
            self.levels,
            self.frame,
            origin,
            directions,
            range_max,
            ranges,
        )


def _max_pyramid(
    heights: NDArray[np.float32],
) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Maxima over blocks of 2, 4, 8... cells, flat, and where each level begins and its width.

    Level 0, the cells, is not stored: looking at a cell's four heights decides it at once.
    """
    across = np.maximum(heights[:, :-1], heights[:, 1:])
    blocks = np.maximum(across[:-1], across[1:])
    maxima: list[NDArray[np.float32]] = []
    levels = [(0, 0)]
    start = 0
    while max(blocks.shape) > 1 and len(levels) <= COARSEST_LEVEL:
        blocks = _halved(_halved(blocks).T).T
        levels.append((start, blocks.shape[1]))
        maxima.append(np.ascontiguousarray(blocks).ravel())
        start += blocks.size
    flat = np.concatenate(maxima) if maxima else np.empty(0, np.float32)
    return flat, np.array(levels, np.int64)


def _halved(blocks: NDArray[np.float32]) -> NDArray[np.float32]:
    """Maxima of each two neighbouring rows; a last row without neighbour stays as it is."""
    return np.maximum.reduceat(blocks, np.arange(0, blocks.shape[0], 2), axis=0)
